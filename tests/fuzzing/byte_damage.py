"""Damage to bytes, of any format."""

from collections.abc import Sequence

import numpy as np

_EDGES = (0, 1, 0x7F, 0x80, 0xFF)
_LENGTHS = (0, 1, 2**15, 2**16 - 1, 2**31 - 1, 2**31, 2**32 - 1, 2**62, 2**63 - 1, 2**64 - 1)
_MOST = 6  # pieces of damage


def damaged(data: bytes, others: Sequence[bytes], rng: np.random.Generator) -> bytes:
    """A few bytes changed, blocks moved, lengths that lie, or the end cut off.

    Args:
        data: an input.
        others: whose pieces may be put in.
        rng: says what.
    """
    result = bytearray(data)
    for _ in range(rng.integers(1, _MOST)):
        size = len(result)
        if not size:
            break
        place = int(rng.integers(size))
        match rng.choice(
            ["byte", "edge", "bit", "length", "cut", "drop", "repeat", "splice"],
            p=[0.2, 0.15, 0.15, 0.2, 0.05, 0.1, 0.05, 0.1],
        ):
            case "byte":
                result[place] = int(rng.integers(256))
            case "edge":
                result[place] = int(rng.choice(_EDGES))
            case "bit":
                result[place] ^= 1 << int(rng.integers(8))
            case "length":
                width = int(rng.choice([2, 4, 8]))
                value = _LENGTHS[rng.integers(len(_LENGTHS))] % 2 ** (8 * width)
                result[place : place + width] = value.to_bytes(width, str(rng.choice(["little", "big"])))
            case "cut":
                del result[place:]
            case "drop":
                del result[place : place + _block(rng)]
            case "repeat":
                block = result[place : place + _block(rng)]
                result[place:place] = block * int(rng.integers(1, 50))
            case "splice":
                other = others[rng.integers(len(others))]
                begin = int(rng.integers(len(other) + 1))
                result[place : place + _block(rng)] = other[begin : begin + _block(rng)]
    return bytes(result)


def _block(rng: np.random.Generator) -> int:
    return int(2 ** rng.uniform(0, 8))
