"""Finds every effect file in the folders of `listed`."""

import importlib
import pkgutil
import sys

from hydrolek_drake.effects import listed
from hydrolek_drake.effects.effect import Effect
from hydrolek_drake.errors import InputError, meant

COMPOSED = "hydrolek_drake.physics.hooks"
"""Module that composes the effects' functions when it is imported, after which none is added."""


def _found() -> dict[str, Effect]:
    effects = {}
    begun = COMPOSED in sys.modules
    names = [found.name for found in pkgutil.walk_packages(listed.__path__, f"{listed.__name__}.")]
    for name in sorted(names, key=lambda name: name.rpartition(".")[2]):
        effect = getattr(importlib.import_module(name), "EFFECT", None)
        if not begun and COMPOSED in sys.modules:
            raise ImportError(
                f"{name} imports a module of physics that composes the effects: import what needs no hook"
            )
        if isinstance(effect, Effect):
            effects[effect.id] = effect
    return effects


EFFECTS: dict[str, Effect] = {}
"""Id -> effect, in alphabetical order of the files."""


def _fill() -> None:
    EFFECTS.update(_found())


_fill()


def effect_named(effect_id: str) -> Effect:
    """The effect of this id.

    Raises:
        InputError: no such effect; names the nearest ones.
    """
    if effect_id not in EFFECTS:
        hint = meant(effect_id, EFFECTS, alike=0.4)
        raise InputError(f"no effect '{effect_id}'; {hint}'hydrolek effects' lists all")
    return EFFECTS[effect_id]
