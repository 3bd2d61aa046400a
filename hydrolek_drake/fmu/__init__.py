"""Functional Mock-up Units: a rig's model for other programs' simulations, and others' models in place of a machine."""
