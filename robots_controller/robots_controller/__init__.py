"""Robot controller: Lua programs, interpolator, I/O and the cell."""
