"""What the processes of a cell agree on, without ROS: topics, modes, results, parameters, the driver."""
