"""Robot programs that are generated from seeds, and what must hold of their runs."""
