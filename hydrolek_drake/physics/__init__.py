"""The physics of each stage as pure compiled functions; every equation stands here once.

The Drake systems and the compiled rollout call the same functions. Each takes the values it works on and,
last, the joint's parameter record (`records.JOINT`).
"""
