"""Force control: pressing with a wanted force, and what must not happen to the force meanwhile."""
