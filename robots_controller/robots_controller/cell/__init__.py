"""The cell without a transport: what hosts a program, brings its motions to the planner and back, reports."""
