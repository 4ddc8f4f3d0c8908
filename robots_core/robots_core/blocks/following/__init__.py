"""Following of a reference that arrives sample by sample, by axes and by a tool."""
