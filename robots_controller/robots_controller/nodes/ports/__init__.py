"""Ports of the blocks over topics and services: clients, links and the messages that they exchange."""
