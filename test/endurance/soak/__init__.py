"""A cell that works for an hour: memory, missed periods and lateness of its loops: make soak."""
