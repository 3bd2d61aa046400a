"""A rig's parameters from recordings, by any of the searches."""

from hydrolek_drake.identification.fit.fitting import RigFit, fit_rig, searched

__all__ = ["RigFit", "fit_rig", "searched"]
