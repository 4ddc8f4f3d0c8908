"""Blocks that follow a reference which is known only as it arrives."""
