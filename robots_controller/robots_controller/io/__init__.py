"""Inputs and outputs: their image, names, maps to the topics of a PLC, and the scripted PLC."""
