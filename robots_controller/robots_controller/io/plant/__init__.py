"""Protocols of plants as ports of an I/O map: Modbus TCP, MQTT and OPC UA."""
