"""From motion commands to motions: the queue, chains that blend, plans and results."""
