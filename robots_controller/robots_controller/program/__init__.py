"""What a robot program shares with its cell: state, motions, interrupts, taught points."""
