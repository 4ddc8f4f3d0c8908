"""How a process of nodes runs: executor, loops, interrupts, middleware, help."""
