"""Fits of many structures from many starts, their rollouts in lanes."""
