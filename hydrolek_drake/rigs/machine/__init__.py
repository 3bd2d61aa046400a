"""The machine that a rig file describes, what of a recording drives it, and the way back to a file's tree."""
