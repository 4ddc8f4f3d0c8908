"""Terramechanics: a wheel on soft soil."""
