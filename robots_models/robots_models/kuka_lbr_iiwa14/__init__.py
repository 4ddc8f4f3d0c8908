"""KUKA LBR iiwa 14 R820."""
