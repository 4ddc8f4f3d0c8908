"""What robots of one maker and build share: the fields of their data."""
