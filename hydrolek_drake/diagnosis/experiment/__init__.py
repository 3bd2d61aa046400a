"""What other data would show: the next experiment, and the smallest size that these would have shown."""
