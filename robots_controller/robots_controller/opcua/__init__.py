"""The robot as an OPC UA server, by the companion specification for robotics."""
