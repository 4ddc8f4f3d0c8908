"""Rows of an I/O map at work: their places, the ports that they lead to, and the values in between."""
