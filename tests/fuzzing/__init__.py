"""Fuzzing: inputs that nobody meant, against everything that reads what comes from outside.

`scripts/fuzz` runs it for long; `test_fuzzing.py` runs a little of each target with every change.
"""
