"""OPC UA: the client of an I/O map, and a scripted PLC that is a server."""
