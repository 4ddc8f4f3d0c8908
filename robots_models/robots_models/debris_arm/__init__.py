"""The debris arm, fictive."""
