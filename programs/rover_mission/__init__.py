"""The rover mission of the paper's section 5.4: an arm on a rover unloads a sensor package."""
