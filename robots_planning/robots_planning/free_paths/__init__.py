"""Paths around obstacles: searched, shortened and rounded, with a certificate for each piece."""
