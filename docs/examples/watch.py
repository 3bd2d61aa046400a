"""Watch a machine: python docs/examples/watch.py REFERENCE REFERENCE ... FOLDER_OF_LATER_RECORDINGS."""

import sys

import hydrolek_drake

*reference, later = sys.argv[1:]
result = hydrolek_drake.watch(
    "joint_bench", reference, later, limits={"cylinder.cross_port_leakage": 1.5e-12}, out="out/watch"
)
print(result.summary())
table = result.to_pandas()
print(table[table["effect"] == "cylinder.cross_port_leakage"][["time", "size", "low", "high", "gain"]])
if result.alarm is not None:
    print("alarm:", result.alarm.effect)
