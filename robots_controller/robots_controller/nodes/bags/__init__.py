"""Nodes that record bags and play them."""
