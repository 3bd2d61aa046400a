"""Data that are diagnosed: whether they can be, which are fitted and held out, and how much each value counts."""
