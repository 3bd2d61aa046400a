"""Sites, ranges of tracks and boom, and the places found: what `hydrolek stand` and `teleop --stand` are given."""

import contextlib
import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from fuzzing.byte_damage import damaged
from fuzzing.target import Input, Target
from fuzzing.tree_damage import damaged_text, damaged_tree, words_of
from hydrolek_drake.standing.base import Placement, drawn_boom_angle, load_base
from hydrolek_drake.standing.clearance import BaseClearance
from hydrolek_drake.standing.place_file import read_place
from hydrolek_drake.standing.reach import ReachMap
from hydrolek_drake.standing.site import make_site, read_site

_SITES = (
    "pipe: {point: [1.87, 0, 1.06], axis: [0, 0, 1], radius: 0.0375, length: 1.2}\ngrasp: -0.05\ncut: 0.12\n",
    "pipe: {point: [2.2, 0.6, 1.0], axis: [0.2, 1, 0.1], length: 1.4}\ngrasp: 0.1\ncut: -0.12\nblocks:\n"
    "  - {name: bench, middle: [1.55, 0.6, 0.3], size: [0.5, 1.6, 0.6], heading_deg: 10}\n"
    "  - {name: wall, middle: [3, 0, 1], size: [0.1, 4, 2]}\n",
)
_BASES = (
    "tracks: {x: {value: [-500, 500], unit: mm, source: room}, heading: {value: [-20, 20], unit: deg}}\n",
    "boom: {angle: {value: [10, 60], unit: deg}}\nwanted: {clearance: {value: 30, unit: mm}}\n"
    "search: {distance_step: {value: 0.2, unit: m}, rounds: {value: 2, unit: '1'}}\n",
)
_PLACES = tuple(
    json.dumps({
        "pipe": {"point": [x, 0.0, 1.06], "axis": [0.0, 0.0, 1.0], "radius": 0.0375, "length": 1.2},
        "places": [{"x": 0.1, "y": -0.2, "heading_deg": 30.0, "boom_deg": 44.5, "grasping": "right"}],
        "reason": "",
    })
    for x in (1.87, 2.4)
)  # fmt: skip
_NAME = {_SITES: "site.yaml", _BASES: "base.yaml", _PLACES: "stand.json"}


@functools.cache
def _trees(texts: tuple[str, ...]) -> tuple[Any, ...]:
    return tuple(yaml.safe_load(text) for text in texts)


def _made(texts: tuple[str, ...], rng: np.random.Generator) -> Input:
    number, kind = int(rng.integers(len(texts))), rng.random()
    text = texts[number]
    if kind < 0.75:
        text = damaged_tree(_trees(texts)[number], words_of(_trees(texts)), _trees(texts), rng)
        if texts is _PLACES and kind < 0.5:
            with contextlib.suppress(Exception):  # of PyYAML, on what is damaged: then it stays as it is
                text = json.dumps(yaml.safe_load(text), default=str)
    if kind > 0.65:
        text = damaged_text(text, rng)
    data = text.encode("utf-8", "replace")
    if kind > 0.93:
        data = damaged(data, [each.encode() for each in texts], rng)
    return Input(_NAME[texts], data)


def _seeds(texts: tuple[str, ...]) -> Callable[[], list[Input]]:
    return lambda: [Input(_NAME[texts], text.encode()) for text in texts]


def _read_site(path: Path) -> str:
    site = make_site(read_site(path), str(path))
    here = Placement(0.0, 0.0, 0.0, drawn_boom_angle())
    assert np.isfinite(BaseClearance(site).of(here, 0.2)[0])
    ReachMap(site).of(here, "right")
    return "read"


def _read_base(path: Path) -> str:
    base = load_base(path)
    base.allows(Placement(0.0, 0.0, 0.0, base.boom[0]))
    return "read"


def _read_place(path: Path) -> str:
    placement, pipe = read_place(path)
    placement.pipe_seen(pipe)
    return "read"


TARGETS = (
    Target("site", functools.partial(_made, _SITES), _read_site, _seeds(_SITES)),
    Target("base", functools.partial(_made, _BASES), _read_base, _seeds(_BASES)),
    Target("place", functools.partial(_made, _PLACES), _read_place, _seeds(_PLACES)),
)
