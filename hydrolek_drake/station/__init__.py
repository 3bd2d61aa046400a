"""A rig in, a Drake Diagram out; and running it."""
