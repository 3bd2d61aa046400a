"""Ask what physics a model leaves out: python docs/examples/diagnose.py [RECORDING]."""

import sys

import hydrolek_drake

recording = sys.argv[1] if len(sys.argv) > 1 else "tests/data/bench/practice_02/train.csv"
whole = hydrolek_drake.read(recording)
result = hydrolek_drake.diagnose("joint_bench", whole, at_most_minutes=2.0)
print(result.verdict)
print(result.summary())
print(result.to_pandas())
