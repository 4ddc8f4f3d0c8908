"""Motion by a person or a sensor: jogging, the teach box, movement in real time."""
