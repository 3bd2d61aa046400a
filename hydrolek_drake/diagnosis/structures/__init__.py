"""Structures: the nominal model and what may be added to it, and the search among them."""
