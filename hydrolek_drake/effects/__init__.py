"""The known effects, each in a file of its own, found by looking into this folder."""

from hydrolek_drake.effects.catalogue import EFFECTS, effect_named
from hydrolek_drake.effects.effect import HOOKS, Effect

__all__ = ["EFFECTS", "HOOKS", "Effect", "effect_named"]
