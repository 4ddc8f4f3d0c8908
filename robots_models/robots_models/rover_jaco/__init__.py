"""Kinova Jaco 2 (j2n6s300)."""
