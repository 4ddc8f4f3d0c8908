"""A robot."""
