"""The command `cell`: starts the nodes, shows what they do, records them and ends them."""
