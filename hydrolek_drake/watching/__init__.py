"""Condition monitoring: what differs, recording by recording, from a machine's healthy reference."""
