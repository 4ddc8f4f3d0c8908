"""Distances of solids, by compiled code: nearest points, pairs of convex parts, and sets of solids."""
