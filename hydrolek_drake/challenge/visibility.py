"""From which size on an effect is found."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any


def visibility_markdown(results: Sequence[Mapping[str, Any]]) -> str:
    """Every effect with the sizes at which it was named and those at which it was missed.

    Sizes are how many times the noise the effect shows by itself on its machine; doubles count for both.

    Args:
        results: as from `scoring.score`.
    """
    found: dict[str, list[float]] = defaultdict(list)
    missed: dict[str, list[float]] = defaultdict(list)
    for result in results:
        for effect, shown in result["shows"].items():
            right = result["right"] if result["kind"] == "unlisted" else effect in result["named"]
            (found if right else missed)[effect].append(shown)
    lines = [
        "| effect | found where it shows (times the noise) | missed | smallest found | largest missed |",
        "|---|---|---|---|---|",
    ]
    for effect in sorted(found.keys() | missed.keys()):
        right, wrong = sorted(found[effect]), sorted(missed[effect])
        lines.append(
            f"| {effect} | {_listed(right)} | {_listed(wrong)} | {_listed(right[:1])} | {_listed(wrong[-1:])} |"
        )
    return "\n".join(lines) + "\n"


def _listed(sizes: Sequence[float]) -> str:
    return ", ".join(f"{size:.2g}" for size in sizes)
