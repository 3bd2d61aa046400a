"""Joints that move together in one compiled loop, of one machine or of many in lanes."""
