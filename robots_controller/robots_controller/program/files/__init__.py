"""Files of a robot program: header, taught points, frames, kept values, and how they are written."""
