"""Damage to YAML as a tree, then as text: values, keys and units that are wrong in ways that YAML can write."""

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np
import yaml

_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
_MARK = "rawtext{}rawtext"

VALUES: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2**31, 2**63 - 1, -(2**63), 0.0, -0.0, 1e-300, 1e300, -1e300, 5e-324,
    float("inf"), float("-inf"), float("nan"), "", " ", "0", "1", "-1", "1e999", "nan", "inf", "-inf", "1_0",
    "0x10", "none", "null", "x" * 300, "a.b", "a/b", "../..", "/", "é", "𝛑", "٣", "% s", "{0}", "%s", "$HOME",
    "~", [], {}, [[]], [None], [0, 0], [1, 2, 3], {"value": 1}, {"a": {"b": {}}}, ["1 s", "2 s"],
)  # fmt: skip
UNITS = (
    "m", "s", "deg", "rad", "Pa", "MPa", "V", "kg", "N m", "1", "%", "", " ", "m^9^9", "m^99", "m**2", "degC",
    "dB", "m/s/s", "(m", "m)", "m**(2)", "1/m", "/", "*", "^", "m m m m", "yottam", "m_per_s", "5 m", "m^-0.5",
    "µm", "°", "m^0", "lambda", "m+m", "[m]", "inch", "furlong", "e", "pi", "hbar", "delta_degC", "°C",
    "m^0.33333",
)  # fmt: skip
QUANTITIES = (
    "1 s", "0 s", "-1 s", "1e300 s", "1e-300 s", "nan s", "inf V", "1 V", "1 m", "1 deg", "5", "5 parsec",
    "1e999 V", "V", "1 V V", "1 V^2/V", "100 %", "101 %", "-100 %", "1e5 s", "1 1 s", ".5 V", "5. V", "+1 V",
    "--1 V", "0x10 V", "1e V",
)  # fmt: skip
RAW = (
    "!!float x", "!!int x", "!!int ''", "!!bool x", "!!timestamp x", "!!timestamp 2026-13-45", "!!binary x",
    "!!null x", "!!set {a}", "!!omap [a: 1]", "!!str 1", "!!float 1", "!!int 1.5", "!x y",
    "!!python/name:os.system x", "!<x> y", "2026-13-45", "2026-11-24", "2026-11-24T25:61:61Z", "9" * 30,
    "9" * 5000, "0b" + "1" * 70, "0o7", "017", "1:30", "1:99:99.5", "*undefined", "&a [*a]", "&a {b: *a}", "<<",
    "{<<: x}", "{<<: [{a: 1}, 2]}", "{? [a] : b}", "{? {a: b}}", "{a, a}", "{1: 2, 1: 3}", "{~: 1}",
    "{yes: 1, true: 2}", "[" * 50 + "]" * 50, "[" * 3000, "{a: " * 60 + "}" * 60, '"\\0"', '"\\x1b[2J"',
    '"\\ud800"', '"\\q"', '"', "'", "|", ">", "|9", ">-\n  x", "%", "@x", "`x", "- x", "? x", ": x", "x: y: z",
    "# x", "---", "...", "--- x\n---\n", "[a", "{a", "]", "}", "\tx", "&a", "&a &b x", "!!map []", "!!seq {}",
    "=", "~", "yes", "on", "off", ".inf", "-.inf", ".nan", "+.5", "1_000", "1__0_", "._", "0.1_", "1e5", "1.e5",
    "1.0e+400",
)  # fmt: skip


def damaged_tree(tree: Any, words: Sequence[str], others: Sequence[Any], rng: np.random.Generator) -> str:
    """A tree with a few places changed, as YAML text; see `changed_tree`."""
    changed, raw = changed_tree(tree, words, others, rng, RAW)
    text = yaml.dump(changed, Dumper=_DUMPER, sort_keys=False, allow_unicode=True, width=10_000)
    for number, each in enumerate(raw):
        text = text.replace(_MARK.format(number), each)
    return text


def changed_tree(
    tree: Any,
    words: Sequence[str],
    others: Sequence[Any],
    rng: np.random.Generator,
    raws: Sequence[str],
    most: int = 4,
) -> tuple[Any, list[str]]:
    """A tree with a few places changed.

    Args:
        tree: content of a good file.
        words: that such files have: keys, names, choices.
        others: trees whose pieces may be put in.
        rng: says what.
        raws: text that stands for itself once the tree is text.
        most: changes.

    Returns:
        The tree, in which `rawtext0rawtext` stands for the first of the raw texts, and those.
    """
    tree = copy.deepcopy(tree)
    raw: list[str] = []
    for _ in range(1 if rng.random() < 0.6 else rng.integers(1, most + 1)):
        places = list(_places(tree))
        if not places:
            break
        parent, key = places[rng.integers(len(places))]
        match rng.choice(
            ["value", "delete", "rename", "add", "piece", "copy", "wrap", "scale"],
            p=[0.3, 0.1, 0.1, 0.1, 0.1, 0.05, 0.05, 0.2],
        ):
            case "value":
                parent[key] = _value(key, words, raw, raws, rng)
            case "delete":
                del parent[key]
            case "rename" if isinstance(parent, dict):
                parent[_key(words, rng)] = parent.pop(key)
            case "add" if isinstance(parent, dict):
                parent[_key(words, rng)] = _value(key, words, raw, raws, rng)
            case "piece":
                found = list(_places(others[rng.integers(len(others))]))
                if found:
                    their_parent, their_key = found[rng.integers(len(found))]
                    parent[key] = copy.deepcopy(their_parent[their_key])
            case "copy":
                their_parent, their_key = places[rng.integers(len(places))]
                if isinstance(parent, list) or _size(tree) < 5000:
                    parent[key] = copy.deepcopy(their_parent[their_key])
            case "wrap":
                parent[key] = [parent[key]] if rng.random() < 0.5 else {_key(words, rng): parent[key]}
            case "scale" if isinstance(parent[key], (int, float)):
                factor = float(rng.choice([-1.0, 0.0, 1e-9, 0.5, 0.9, 1.1, 2.0, 1e9, 1e300]))
                parent[key] = parent[key] * factor
    return tree, raw


def damaged_text(text: str, rng: np.random.Generator) -> str:
    """YAML text with lines moved, indented otherwise, or with a piece of syntax put in."""
    lines = text.split("\n")
    for _ in range(rng.integers(1, 4)):
        place = int(rng.integers(len(lines)))
        line = lines[place]
        match rng.choice(["insert", "twice", "drop", "indent", "tab", "inside", "join"]):
            case "insert":
                indent = len(line) - len(line.lstrip())
                lines.insert(place, " " * indent + str(rng.choice(RAW)))
            case "twice":
                lines.insert(place, line)
            case "drop":
                if len(lines) > 1:
                    del lines[place]
            case "indent":
                lines[place] = " " * int(rng.integers(0, 5)) + line.lstrip()
            case "tab":
                lines[place] = "\t" + line
            case "inside":
                at = int(rng.integers(len(line) + 1))
                lines[place] = (
                    line[:at]
                    + str(rng.choice([*RAW, *VALUES[16:20], ":", ",", "\x00", "\u2028", "\ufeff"]))
                    + line[at:]
                )
            case "join":
                if place + 1 < len(lines):
                    lines[place : place + 2] = [line + lines[place + 1]]
    return "\n".join(lines)


def words_of(trees: Sequence[Any]) -> list[str]:
    """All keys and short texts of some trees."""
    found: dict[str, None] = {}
    for tree in trees:
        for parent, key in _places(tree):
            for each in (key, parent[key]):
                if isinstance(each, str) and len(each) <= 40:
                    found[each] = None
    return list(found)


def _value(
    key: Any, words: Sequence[str], raw: list[str], raws: Sequence[str], rng: np.random.Generator
) -> Any:
    kind = rng.random()
    if key == "unit" and kind < 0.7:
        return str(rng.choice(UNITS))
    if kind < 0.35:
        return copy.deepcopy(VALUES[rng.integers(len(VALUES))])
    if kind < 0.55:
        raw.append(str(rng.choice(raws)))
        return _MARK.format(len(raw) - 1)
    if kind < 0.7:
        return str(rng.choice(QUANTITIES))
    if kind < 0.85:
        return str(rng.choice(words))
    return float(rng.choice([-1.0, 1.0])) * float(10.0 ** rng.uniform(-12, 12))


def _key(words: Sequence[str], rng: np.random.Generator) -> Any:
    if rng.random() < 0.7:
        return str(rng.choice(words))
    value = VALUES[rng.integers(len(VALUES))]
    return str(value) if isinstance(value, (list, dict)) else value


def _places(tree: Any) -> Any:
    """(mapping or list, key or number) of everything in a tree."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        keys: Any = node if isinstance(node, dict) else range(len(node)) if isinstance(node, list) else ()
        for key in list(keys):
            yield node, key
            waiting.append(node[key])


def _size(tree: Any) -> int:
    return sum(1 for _ in _places(tree))
