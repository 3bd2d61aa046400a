"""Linkage, load and base."""
