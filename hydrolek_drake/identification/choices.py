"""What a fit can be asked to do, by name; apart from what does it, so that a command line is checked at once."""

METHODS = ("ga", "nsga2", "de", "cma", "least-squares")
"""Searches."""

PLANTS = ("rollout", "diagram")
"""Executions of the plant that a fit can run against."""

LOSSES = ("linear", "soft_l1", "huber", "cauchy")
"""Robust losses of the least squares."""
