"""Path planning: trajectory generators, verification, and the switch between them."""
