"""Structures: the nominal model and what may be added to it, and the data that they are fitted to."""
