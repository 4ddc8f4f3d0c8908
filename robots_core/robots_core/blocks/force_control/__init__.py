"""Force control: pressing with a commanded force, and what must not happen to the force meanwhile."""
