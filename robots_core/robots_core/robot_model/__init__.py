"""Robot models: the plugin interface and what it is made of."""
