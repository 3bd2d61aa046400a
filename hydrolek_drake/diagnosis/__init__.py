"""Diagnosis: locate the mismatch, name the missing physics, model it, show the fit improve."""
