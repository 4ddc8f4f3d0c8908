"""What editors use: the debug adapter and the metadata for completion."""
