"""What the processes of a cell agree on, without ROS: modes, results, writers, parameters, the driver."""
