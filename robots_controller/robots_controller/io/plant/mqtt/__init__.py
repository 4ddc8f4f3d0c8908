"""MQTT: the client of an I/O map, and a scripted PLC that is at a broker."""
