"""Collision checks along joint paths: bounds between samples, searches for approaches, and proofs."""
