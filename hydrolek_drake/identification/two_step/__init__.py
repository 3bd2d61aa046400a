"""Two-step identification of a hydraulic joint: mechanics with a gain first, then hydraulics (thesis 4.3, 4.7)."""
