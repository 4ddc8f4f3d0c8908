"""Who may load the page: its server, passwords, origins and the 3D view behind them."""
