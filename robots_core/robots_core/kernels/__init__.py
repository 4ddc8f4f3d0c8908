"""Compiled functions that several blocks share: of small matrices, vectors, and serial chains."""
