"""Fit two of a rig's parameters: python docs/examples/fit.py [RECORDING]."""

import sys

import hydrolek_drake

recording = sys.argv[1] if len(sys.argv) > 1 else "tests/data/bench/practice_01/train.csv"
short = hydrolek_drake.read(recording).between(0.0, 8.0)
result = hydrolek_drake.fit(
    "joint_bench", short, parameters=["supply.pressure", "command.delay"], method="cma", budget=200
)
print(result.summary())
print(result.to_pandas())
print(hydrolek_drake.replay(result.rig, short).summary())  # the fitted rig goes into every other function
