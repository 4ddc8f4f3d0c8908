"""Wording of what is said to a person: names that were meant, valid choices, numbers, the note on safety."""
