"""Staubli RX160."""
