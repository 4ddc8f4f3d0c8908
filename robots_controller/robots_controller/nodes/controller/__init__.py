"""What controller_node consists of: its parameters, commanders, watched nodes, writers and zones."""
