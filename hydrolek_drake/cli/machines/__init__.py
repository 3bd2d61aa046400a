"""Commands about rigs, their models and their recordings."""
