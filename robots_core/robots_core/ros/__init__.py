"""What all nodes share: messages, quality of service, parameters, health, spinning."""
