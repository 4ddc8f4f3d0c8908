"""Motion cueing: what a simulator's cabin does so that a person feels a vehicle move."""
