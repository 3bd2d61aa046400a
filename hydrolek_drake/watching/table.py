"""The watch as a table: one row a recording and effect."""

import io
import json
from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
from typing import Any

from hydrolek_drake.watching.alarms import key_of
from hydrolek_drake.watching.store import Seen

COLUMNS = (
    "recording", "time", "time_from", "reference", "effect", "joint", "size", "low", "high", "unit", "gain",
    "evidence", "parameters", "beside_size", "beside_low", "beside_high", "beside_gain", "over_noise",
    "over_noise_with", "counted", "others", "own", "sha256", "problem",
)  # fmt: skip
"""`size`, `low`, `high`: SI, with the 95 % interval. `gain`: fall of the squares. `evidence`: of this recording and
those before it, over what an alarm asks for. `beside_...`: the same beside the effect that gains most, where that one
is surely there. `over_noise`: times the noise that the nominal model leaves; `over_noise_with`: that the one with the
effect does. `others`: the effect's other parameters, and `own`: the machine's own numbers, both as JSON in SI.
`problem`: why a recording could not be asked."""

Shares = Mapping[str, Mapping[str, float]]
"""Content hash of a recording -> effect (`alarms.key_of`) -> evidence over what an alarm asks for."""


def table_of(seen: Sequence[Seen], evidence: Shares) -> dict[str, list[Any]]:
    """Column -> values.

    Args:
        seen: recordings, in the order of the rows.
        evidence: after those that were judged.
    """
    rows: list[dict[str, Any]] = []
    for each in seen:
        common = {
            "recording": each.recording,
            "time": datetime.fromtimestamp(each.stamp.seconds, timezone.utc),
            "time_from": each.stamp.source,
            "reference": each.reference,
            "sha256": each.digest,
            "problem": each.problem or None,
        }
        if each.answer is None:
            rows.append(common)
            continue
        for told in sorted(each.answer.effects, key=lambda e: (e.effect, e.joint)):
            rows.append(
                {
                    **common,
                    "effect": told.effect,
                    "joint": told.joint,
                    "size": told.size,
                    "low": told.low,
                    "high": told.high,
                    "unit": told.unit,
                    "gain": told.gain,
                    "evidence": evidence.get(each.digest, {}).get(key_of(told)),
                    "parameters": told.parameters,
                    "beside_size": told.beside_size,
                    "beside_low": told.beside_low,
                    "beside_high": told.beside_high,
                    "beside_gain": told.beside_gain,
                    "over_noise": each.answer.left,
                    "over_noise_with": told.left,
                    "counted": each.answer.counted,
                    "others": json.dumps(told.others),
                    "own": json.dumps(each.answer.own),
                }
            )
    return {name: [row.get(name) for row in rows] for name in COLUMNS}


def as_parquet(seen: Sequence[Seen], evidence: Shares) -> bytes:
    """The table as a Parquet file."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    floats = [
        name
        for name in COLUMNS
        if name.partition("_")[0] in ("size", "low", "high", "gain", "evidence", "beside", "over")
    ]
    numbers = dict.fromkeys(floats, pa.float64())
    kinds = {
        **dict.fromkeys(COLUMNS, pa.string()),
        **numbers,
        "time": pa.timestamp("us", tz="UTC"),
        "reference": pa.bool_(),
        "parameters": pa.int64(),
        "counted": pa.int64(),
    }
    schema = pa.schema([(name, kinds[name]) for name in COLUMNS])
    data = io.BytesIO()
    pq.write_table(pa.table(table_of(seen, evidence), schema=schema), data)
    return data.getvalue()
