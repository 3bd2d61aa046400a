"""Supply, oil, valve and cylinder."""
