"""What is implausible about a rig, and about a recording of it, before anything is fitted."""
