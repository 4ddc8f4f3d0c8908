"""ROS 2 nodes: thin shells around the blocks."""

from robots_core.ros.running.interrupt import end_at_once_while_loading

end_at_once_while_loading()
