"""Tools, bases and payloads of a cell, measured, and saved by name."""
