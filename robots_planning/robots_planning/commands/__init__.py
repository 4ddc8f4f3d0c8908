"""From motion commands to motions: the queue, chains that blend, motion primitives, plans and results."""
