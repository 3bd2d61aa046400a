"""What a rig file states: keys that it may have, each parameter's declaration and value, and the arms' loads."""
