"""Digital twin of hydraulic manipulators on Drake."""

__version__ = "0.1.0"
