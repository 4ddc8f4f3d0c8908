"""The functions of robot programs, a family per file: rows of the table, and what they do."""
