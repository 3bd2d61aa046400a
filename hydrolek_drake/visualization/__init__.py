"""Pictures of the machine."""
