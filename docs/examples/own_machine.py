"""A machine of one's own, from a data sheet and a logger's columns to a fitted rig.

python docs/examples/own_machine.py [RECORDING]
"""

import sys
from pathlib import Path

import hydrolek_drake

RIG = """\
schema: 1
name: my_axis
title: My axis, by its data sheet
based_on: joint_bench  # the built-in rig nearest to it; `hydrolek rig new` writes one from all of a data sheet
supply:
  pressure: {value: 11.5, unit: MPa, source: "data sheet", range: [9, 14]}
joints:
  joint:
    command:
      delay: {value: 30, unit: ms, source: "nobody knows", range: [5, 80]}
recording:
  columns: {t: time_s, U_valve: joint.command_V, phi: joint.angle_rad}  # as the logger names them
"""

recording = sys.argv[1] if len(sys.argv) > 1 else "tests/data/bench/practice_01/train.csv"
frame = hydrolek_drake.to_pandas(hydrolek_drake.read(recording))
frame.columns = ["t", "U_valve", "phi"]  # what a logger would have written
path = Path("my_axis.yaml")
path.write_text(RIG, encoding="utf-8")
rig = hydrolek_drake.load_rig(path)
print("before:", hydrolek_drake.replay(rig, frame).summary())
result = hydrolek_drake.fit(rig, frame)  # every number with a range
print(result.summary())
print("after:", hydrolek_drake.replay(result.rig, frame).summary())
print(result.to_pandas())
print("written:", *result.write("out/own_machine"))  # rig_fitted.yaml goes into every command
