"""What the operator points at in a snapshot, and the pictures in which it is shown."""
