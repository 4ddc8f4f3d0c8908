"""Mitsubishi RV-7FRL."""
