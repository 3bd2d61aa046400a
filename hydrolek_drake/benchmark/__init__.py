"""How fast the executions are, as ratios measured in one run."""
