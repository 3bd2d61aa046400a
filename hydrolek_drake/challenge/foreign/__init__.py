"""Machines that are not ours: a simulator that shares no equation with the rest, and data sheets that are wrong."""
