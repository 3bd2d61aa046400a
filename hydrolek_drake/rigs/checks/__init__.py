"""What a rig is refused for when it is loaded or changed: parameters that contradict each other."""
