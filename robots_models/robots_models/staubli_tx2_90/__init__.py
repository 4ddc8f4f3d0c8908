"""Staubli TX2-90."""
