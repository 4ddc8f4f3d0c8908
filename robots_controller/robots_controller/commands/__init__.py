"""The commands of a shell: one table of them, what they take, and how they end."""
