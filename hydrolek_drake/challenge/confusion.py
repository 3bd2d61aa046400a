"""What was concealed against what was named."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

NOTHING = "nothing"


def confusions(results: Sequence[Mapping[str, Any]]) -> Counter[tuple[str, str]]:
    """(concealed, named) -> how often.

    What was concealed and named counts by itself; what is left of a case counts with each wrong name that was
    given, or with nothing.

    Args:
        results: as from `scoring.score`.
    """
    counted: Counter[tuple[str, str]] = Counter()
    for result in results:
        truth, named = _truth(result), _named(result)
        if result["kind"] == "unlisted" and result["right"]:
            named = named[-1:]  # known effects beside it do no harm
        both = [name for name in truth if name in named]
        counted.update((name, name) for name in both)
        missed = [name for name in truth if name not in both]
        wrong = [name for name in named if name not in both]
        if missed or wrong:
            counted.update((m, w) for m in missed or [NOTHING] for w in wrong or [NOTHING])
        elif not both:
            counted[NOTHING, NOTHING] += 1
    return counted


def confusion_markdown(results: Sequence[Mapping[str, Any]]) -> str:
    """The matrix as a table: a row for each thing concealed, a column for each thing named."""
    counted = confusions(results)
    rows = sorted({truth for truth, _ in counted}, key=_order)
    columns = sorted({named for _, named in counted}, key=_order)
    lines = ["| concealed \\ named | " + " | ".join(columns) + " |", "|---" * (len(columns) + 1) + "|"]
    for row in rows:
        cells = [str(counted[row, column] or "") for column in columns]
        lines.append(f"| {row} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _order(name: str) -> tuple[bool, str]:
    return name != NOTHING, name


def _truth(result: Mapping[str, Any]) -> list[str]:
    """Ids; physics in no list is told by its verdict."""
    if result["kind"] == "unlisted":
        return [f"unlisted: {name}" for name in result["truth"]]
    return list(result["truth"])


def _named(result: Mapping[str, Any]) -> list[str]:
    named = list(result["named"])
    if result["verdict"] == "unlisted_physics":
        named.append(f"unlisted at {result['stage']}" if result["stage"] else "unlisted, place unknown")
    return named
