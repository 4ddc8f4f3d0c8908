"""What the robots of this package look like: our own drawings, one file for a robot or a family."""
