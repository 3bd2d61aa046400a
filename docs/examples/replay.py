"""Replay a recording on its rig's model: python docs/examples/replay.py [RECORDING]."""

import sys

import hydrolek_drake

recording = sys.argv[1] if len(sys.argv) > 1 else "tests/data/bench/practice_01/train.csv"
frame = hydrolek_drake.to_pandas(hydrolek_drake.read(recording))  # any DataFrame with these columns will do
result = hydrolek_drake.replay("joint_bench", frame, between=(0.0, 10.0))
print(result.summary())
print(result.to_pandas()[["unit", "rms", "rms_over_noise"]])
result.plot()  # a Plotly figure; a notebook shows it, .show() opens it, .write_html("replay.html") keeps it
