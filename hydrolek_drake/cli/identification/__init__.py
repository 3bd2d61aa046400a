"""Commands that fit models to recordings."""
