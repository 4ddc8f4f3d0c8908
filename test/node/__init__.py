"""Node tests: real nodes, each test in a ROS domain of its own."""
