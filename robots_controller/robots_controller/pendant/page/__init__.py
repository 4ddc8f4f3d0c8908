"""The operator's page, made with NiceGUI."""
