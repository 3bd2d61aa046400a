"""Linkages between cylinder and joint beyond a triangle: a four-bar mechanism, a table of the lever."""
