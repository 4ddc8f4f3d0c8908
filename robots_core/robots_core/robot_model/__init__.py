"""Robot models: the plugin interface of a robot and the records and models that it consists of."""
