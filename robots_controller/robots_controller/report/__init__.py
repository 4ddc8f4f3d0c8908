"""What a recorded run did: figures, a page in one file, a terminal summary, a comparison of two runs."""
