"""The controllers' end of the link: full hydraulic plant, simple arms, or a user's own machine."""
