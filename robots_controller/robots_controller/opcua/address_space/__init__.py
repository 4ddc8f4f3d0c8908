"""The address space of the OPC UA server: the types and nodes of a robot, its program and its channels."""
