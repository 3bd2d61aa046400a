"""Experiments: recordings prepared so that rollouts can be held against them."""
