"""Figures of the paper's applications: what their plots share."""
