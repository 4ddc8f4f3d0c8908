"""Bag tests: recorded bags, replayed into real nodes."""
