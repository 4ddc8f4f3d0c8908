"""ROS 2 nodes: thin shells around the blocks."""

import robots_core.nodes  # noqa: F401  # interrupts are minded from here on
