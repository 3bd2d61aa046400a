"""Rig files: which machine it is, with every parameter's value, unit, source and range."""

from hydrolek_drake.rigs.loading import built_in_rigs, built_in_titles, load_rig
from hydrolek_drake.rigs.rig import Entry, Rig

__all__ = ["Entry", "Rig", "built_in_rigs", "built_in_titles", "load_rig"]
