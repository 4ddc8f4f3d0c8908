"""Files that users give, read whole or refused with file and line; and results kept by their content."""
