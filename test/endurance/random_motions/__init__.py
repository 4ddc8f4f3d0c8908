"""Random motions of all robots, held to their limits by plain differences: make random-motions."""
