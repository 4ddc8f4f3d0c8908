"""The wheel laboratory of the paper's section 5.2: a KUKA KR 210 that drives a wheel over soil."""
