"""Drawing concealed cases: which machine, which effect, how large, how driven."""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.challenge.build import Build, build_of
from hydrolek_drake.challenge.cases import CASE_KEYS, TRAIN_S, Case, driven, read_case, with_concealed
from hydrolek_drake.files import read_kept, write_whole
from hydrolek_drake.rigs import Rig

INDIVIDUAL = 0.12
"""Machines of one build differ by so much, uniformly."""

SHOWS = {"barely": 1.5, "middle": 6.0, "large": 30.0}
"""Size of an effect: how many times the noise the nominal equations, with the machine's own numbers, are wrong."""

KINDS = (("healthy", 0.3), ("single", 0.45), ("double", 0.12), ("unlisted", 0.13))
"""Kind of case -> share of all."""

FRICTIONS = {"cylinder.coulomb_friction", "cylinder.stribeck_friction"}
"""One holds the other, so a machine has only one of them."""

SIZING_STEP_S = 5e-5
"""Integration step while an effect's size is sought, which need not be exact."""

SCALINGS = 3
DRIVES = 3
"""Commands are drawn so often: not every one takes a joint to where its effects show."""
LARGEST_SCALING = 20.0
"""Sizes stay within this factor of those in sizes.yaml: beyond, a worn joint would have been scrapped."""

Draft = tuple[Build, str, str, list[str], list[str]]
"""Machine, kind, level, names of listed effects and of physics in no list."""


def individual(build: Build, rng: np.random.Generator) -> dict[str, float]:
    """Numbers of one machine among many of the same build: field of the machine -> value."""
    return {
        field: build.rig.value(path) * float(rng.uniform(1 - INDIVIDUAL, 1 + INDIVIDUAL))
        for field, path in build.spread.items()
    }


def draw_cases(
    rigs: Sequence[Rig],
    count: int,
    seed: int,
    kinds: Sequence[tuple[str, float]] = KINDS,
    kept: Path | None = None,
    pool: Executor | None = None,
    tell: Callable[[str], None] = lambda text: None,
) -> list[Case]:
    """Cases in random order, so that the first ones are a fair sample of all.

    Sizes are found by simulation, which takes seconds a case. Each case has random numbers of its own, so that they
    can be drawn side by side and one by one.

    Args:
        rigs: taken in turn; their numbers are all that machine and diagnosis share.
        count: how many.
        seed: of everything random.
        kinds: as `KINDS`.
        kept: folder of the labels drawn so far, from which an interrupted drawing goes on; not kept without.
        pool: draws side by side.
        tell: is told how far it is.
    """
    rng = np.random.default_rng(seed)
    builds = [build_of(rig) for rig in rigs]
    drafts = drafted(builds, count, rng, np.random.default_rng((seed, len(builds))), kinds)

    def drawn(number: int, draft: Draft, own: np.random.SeedSequence) -> Case:
        label = kept / f"case_{number:03d}.json" if kept else None
        if label and label.exists():
            return read_case(read_kept(label, "the machine drawn before", CASE_KEYS))
        case = _case(number, *draft, np.random.default_rng(own))
        if label:
            write_whole(label, json.dumps(asdict(case)))
        return case

    cases = []
    side_by_side = pool.map if pool else map
    for case in side_by_side(drawn, range(1, count + 1), drafts, np.random.SeedSequence(seed).spawn(count)):
        cases.append(case)
        tell(f"machine {len(cases)} of {count} drawn (sizes are found by simulation) ...")
    return cases


def drafted(
    builds: Sequence[Build],
    count: int,
    rng: np.random.Generator,
    rng_builds: np.random.Generator,
    shares: Sequence[tuple[str, float]] = KINDS,
) -> list[Draft]:
    """What is concealed in which machine, in random order; sizes and commands are drawn later.

    Args:
        builds: taken in turn.
        count: how many.
        rng: of kinds and effects.
        rng_builds: of the order of the builds.
        shares: kinds of cases, as `KINDS`.
    """
    kinds = [kind for kind, share in shares for _ in range(max(round(share * count), 1))][:count]
    kinds += ["single"] * (count - len(kinds))
    listed = _in_turn(list(dict.fromkeys(name for build in builds for name in build.listed)), rng)
    unlisted = _in_turn(list(builds[0].unlisted), rng)
    levels = _in_turn(list(SHOWS), rng)
    turns = _in_turn(builds, rng_builds)
    drafts: list[Draft] = []
    for kind in kinds:
        build = next(turns)
        possible = (name for name in listed if name in build.listed)
        names = [next(possible) for _ in range({"single": 1, "double": 2}.get(kind, 0))]
        while len(set(names)) < len(names) or FRICTIONS <= set(names):
            names[1] = next(possible)
        level = "" if kind == "healthy" else next(levels) if kind == "single" else "middle"
        drafts.append((build, kind, level, names, [next(unlisted)] if kind == "unlisted" else []))
    rng.shuffle(drafts)
    return drafts


def _in_turn(items: Sequence[Any], rng: np.random.Generator) -> Iterator[Any]:
    """Every item once, in random order, again and again."""
    while True:
        yield from (items[i] for i in rng.permutation(len(items)))


def _case(
    number: int,
    build: Build,
    kind: str,
    level: str,
    names: list[str],
    strange: list[str],
    rng: np.random.Generator,
) -> Case:
    own = individual(build, rng)
    machine = build.nominal._replace(**own)
    drive = "closed" if rng.random() < 0.5 else "open"
    pressures = bool(rng.random() < 0.5)
    seed = int(rng.integers(2**31))
    concealed = {name: build.listed[name] for name in names} | {n: build.unlisted[n] for n in strange}
    scaled: dict[str, dict[str, float]] = {}
    shows: dict[str, float] = {}
    for tried in (drive, *("open",) * DRIVES):
        if tried == drive == "open" and scaled:
            seed = int(rng.integers(2**31))
        drive = tried
        scaled = {
            name: _scaled(build, machine, name, entry, level, drive, seed, rng)
            for name, entry in concealed.items()
        }
        shows = _shown(build, machine, scaled, drive, seed)
        if all(shown > 0.5 * SHOWS[level] for shown in shows.values()):
            break  # else a controller or these commands keep the joint from where an effect shows
    return Case(
        name=f"case_{number:03d}",
        kind=kind,
        size=level,
        drive=drive,
        pressures=pressures,
        effects={name: scaled[name] for name in names},
        unlisted={name: scaled[name] for name in strange},
        stages=(*(name.split(".")[0] for name in names), *(build.unlisted[n]["stage"] for n in strange)),
        machine=own,
        seed=seed,
        rig=build.rig.name,
        shows=shows,
    )


def _scaled(
    build: Build,
    machine: Any,
    name: str,
    entry: Mapping[str, Any],
    level: str,
    drive: str,
    seed: int,
    rng: np.random.Generator,
) -> dict[str, float]:
    """Parameters of an effect, scaled until it shows as much as wanted by itself."""
    drawn = {p: float(math.exp(rng.uniform(*np.log(ends)))) for p, ends in entry.get("draw", {}).items()}
    sign = -1.0 if entry.get("signed") and rng.random() < 0.5 else 1.0
    factor = 1.0
    parameters: dict[str, float] = {}
    for _ in range(SCALINGS):
        parameters = {p: sign * v * factor for p, v in entry["size"].items()} | drawn
        shown = _mismatch(build, machine, with_concealed(machine, {name: parameters}), drive, seed)
        ratio = SHOWS[level] / max(shown, 0.02)
        factor *= 1.0 / ratio if entry.get("weakens") else ratio
        factor = min(max(factor, 1.0 / LARGEST_SCALING), LARGEST_SCALING)
    return parameters


def _shown(
    build: Build, machine: Any, concealed: Mapping[str, Mapping[str, float]], drive: str, seed: int
) -> dict[str, float]:
    """How many times the noise each one shows beside the others."""
    together = with_concealed(machine, concealed)
    shows = {}
    for name in concealed:
        others = with_concealed(machine, {other: p for other, p in concealed.items() if other != name})
        shows[name] = _mismatch(build, others, together, drive, seed)
    return shows


def _mismatch(build: Build, plain: Any, changed: Any, drive: str, seed: int) -> float:
    """Root mean square of what the machine without the effect does otherwise in the training data, over the noise."""
    done = driven(build, changed, drive, TRAIN_S, np.random.default_rng(seed), 0.0, SIZING_STEP_S)
    without = build.replay(plain, done.volts, SIZING_STEP_S)
    shown = float(np.sqrt(np.mean((done.reading - without.reading) ** 2))) / build.noise
    return shown if math.isfinite(shown) else 10.0 * SHOWS["large"]
