"""KUKA KR 500 R2830 on a linear axis."""
