"""Controllers compared and judged."""
