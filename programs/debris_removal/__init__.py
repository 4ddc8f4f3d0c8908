"""Active debris removal of the paper's section 5.3: an arm on a satellite grasps a tumbling target."""
