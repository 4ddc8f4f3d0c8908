"""The controller: follows trajectories and streams on time, on the path, inside the limits."""
