"""Least squares: fits from starts, many in lockstep, by continuation, and the profiles of what they found."""
