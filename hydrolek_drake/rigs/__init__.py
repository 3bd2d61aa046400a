"""Rig files: which machine it is, with every parameter's value, unit, source and range."""

from hydrolek_drake.rigs.machine.rig import Entry, Rig
from hydrolek_drake.rigs.reading.loading import built_in_rigs, built_in_titles, load_rig

__all__ = ["Entry", "Rig", "built_in_rigs", "built_in_titles", "load_rig"]
