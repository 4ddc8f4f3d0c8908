"""Recorded bags: written so that a crash costs little, read, compared and replayed."""
