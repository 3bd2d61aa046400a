"""The stages as Drake LeafSystems, one a file, each a vector over the joints of a rig.

A system only moves values between its ports and the functions of `hydrolek_drake.physics`. All vectors run
over the joints in the rig's order; pairs of values stand as all of side A, then all of side B.
"""
