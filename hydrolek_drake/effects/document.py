"""The catalogue as a page of documentation, `docs/reference/effects.md`."""

from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.effects.effect import HOOKS, Effect

_HEAD = """# The known effects

Physics that the nominal model leaves out, one file each in the folders of
`hydrolek_drake/effects/listed/`. Every effect is part of every rig and off until its size leaves its neutral value:

```yaml
effects:
  cylinder.coulomb_friction:
    coulomb_N: {value: 900, unit: N, source: "seal catalogue"}
```

This page is written by `hydrolek_drake.effects.document.effects_markdown()`; a test keeps it current.
"""
_HOW_TO = """## How to add an effect: one file and one test

1. Add `<stage>_<name>.py` to the folder of `hydrolek_drake/effects/listed/` that it belongs to. It declares
   `EFFECT = Effect(id="<stage>.<name>", ...)` with equation, formula, source, parameters (each with a neutral
   value, its unit at the end of its name), what to inspect on the machine and what it can be confused with, and
   registers one compiled function per hook with `@EFFECT.hook("<hook>")` above `@njit`. The function must return the
   hook's neutral contribution when the effect's size is neutral. `cylinder_coulomb_friction.py` is a good pattern.
   The file is found by itself; the rig files, both executions and this page know it at once.
2. Add its closed form to `tests/effects/test_effect_laws.py` and a size to the tables of
   `tests/effects/test_catalogue.py`, `tests/rollout/test_bench_recordings.py` and `scripts/agreement_effects.json`,
   whose tests then check that neutral changes nothing bit for bit, that it shows when on, that the integration
   step is fine enough, and that Diagram and rollout agree.

Then write this page anew:

```console
python -c "from hydrolek_drake.effects import document; print(document.effects_markdown(), end='')" \\
  > docs/reference/effects.md
```

| Hook | What the function gives |
|---|---|
"""


def effects_markdown() -> str:
    """The whole page: a table of all effects, each in full, and how to add one."""
    ordered = sorted(EFFECTS.values(), key=lambda effect: effect.id)
    lines = [_HEAD, "| Effect | What |", "|---|---|"]
    lines += [f"| [`{effect.id}`](#{_anchor(effect.id)}) | {effect.title} |" for effect in ordered]
    lines += ["", *(_in_full(effect) for effect in ordered)]
    hooks = "".join(f"| `{name}` | {_cell(meaning)} |\n" for name, meaning in HOOKS.items())
    return "\n".join(lines) + "\n" + _HOW_TO + hooks


def _anchor(effect_id: str) -> str:
    return effect_id.replace(".", "")  # as headings are turned into anchors


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _in_full(effect: Effect) -> str:
    lines = [
        f"## {effect.id}",
        "",
        f"{effect.title[0].upper()}{effect.title[1:]}. {effect.inspect}".rstrip(),
        "",
        f"- Equation: {effect.equation}",
        f"- Source: {effect.source}",
        f"- Enters at: {', '.join(f'`{hook}`' for hook in effect.hooks)}",
    ]
    if effect.needs:
        needed = "; ".join(f"{section}: {', '.join(names)}" for section, names in effect.needs.items())
        lines.append(f"- Acts on: {needed}")
    lines += ["", "| Parameter | Unit | Neutral | Meaning |", "|---|---|---|---|"]
    for p in effect.parameters:
        size = " (size)" if p.name == effect.size else ""
        lines.append(f"| `{p.name}`{size} | {p.unit} | {p.neutral:g} | {_cell(p.meaning)} |")
    lines += ["", "Can be confused with:", ""]
    lines += [f"- `{other}`: {why}" for other, why in effect.confused_with.items()]
    return "\n".join(lines) + "\n"
