"""A satellite whose arm grasps a tumbling target: floating base, free rotation, grasp, reaction wheels."""
