"""Scenario files: what a rig is commanded, for how long and from where, and the Drake Diagram of that."""
