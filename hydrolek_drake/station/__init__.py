"""Rig and scenario in, Drake Diagram out; and running it."""
