"""Recordings as tables: CSV and Parquet."""

import functools
import io
from typing import Any

import numpy as np

from fuzzing.byte_damage import damaged
from fuzzing.reading import read, seeds_of
from fuzzing.strange_columns import CELLS, ROWS, good_columns, strange_columns
from fuzzing.target import Input, Target


def _csv_text(columns: dict[str, np.ndarray], rng: np.random.Generator) -> str:
    """Text with a separator, quotes and line ends of many kinds."""
    separator = str(rng.choice([",", ",", ",", ",", ",", ";", "\t", "|", " "]))
    end = str(rng.choice(["\n", "\n", "\r\n", "\r"]))
    decimal = str(rng.choice([".", ".", ".", ".", ","]))
    rows = [[*columns]]
    rows += [
        [str(value).replace(".", decimal) for value in row] for row in zip(*columns.values(), strict=False)
    ]
    for _ in range(rng.integers(0, 4)):
        row = rows[rng.integers(len(rows))]
        if row and rng.random() < 0.8:
            row[rng.integers(len(row))] = str(rng.choice(CELLS))
        elif rng.random() < 0.5:
            row.append(str(rng.choice(CELLS)))
        else:
            rows.insert(
                int(rng.integers(len(rows))), [str(rng.choice(["# note", "", " ", '"', "\x1a", ",,,"]))]
            )
    return end.join(separator.join(row) for row in rows) + (end if rng.random() < 0.9 else "")


def _csv(rng: np.random.Generator) -> Input:
    name = str(rng.choice(["run.csv", "run.csv", "run.tsv", "run.txt", "run.dat"]))
    columns = good_columns(rng) if rng.random() < 0.5 else strange_columns(rng)
    data = _csv_text(columns, rng).encode(
        str(rng.choice(["utf-8", "utf-8", "utf-8", "utf-8-sig", "utf-16", "cp1252"])), "replace"
    )
    if rng.random() < 0.3:
        data = damaged(data, [_csv_seeds()[0].data], rng)
    return Input(name, data)


def _csv_seeds() -> list[Input]:
    columns = good_columns(np.random.default_rng(1))
    lines = [
        ",".join(columns),
        *(",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)),
    ]
    text = "\n".join(lines) + "\n"
    decimal_comma = text.replace(",", ";").replace(".", ",").replace("j,", "j.")
    return [
        Input("run.csv", text.encode()),
        Input("run.tsv", text.replace(",", "\t").encode()),
        Input("run.txt", decimal_comma.encode("utf-16")),
    ]


def _parquet_bytes(columns: dict[str, Any], **options: Any) -> bytes:
    import pyarrow
    from pyarrow import parquet

    arrays = {name: pyarrow.array(values) for name, values in columns.items()}
    stream = io.BytesIO()
    parquet.write_table(pyarrow.table(arrays), stream, **options)
    return stream.getvalue()


@functools.cache
def _parquet_files() -> list[bytes]:
    import pyarrow

    columns: dict[str, Any] = dict(good_columns(np.random.default_rng(1)))
    stamped = {
        "time": (1e9 * columns["time_s"]).astype("datetime64[ns]"),
        "j.angle_deg": columns["j.angle_deg"],
    }
    odd = columns | {
        "list": pyarrow.array([[1.0]] * ROWS),
        "text": pyarrow.array(["a"] * ROWS),
        "some": pyarrow.array([None, 1.0] * (ROWS // 2)),
        "kind": pyarrow.array(["a", "b"] * (ROWS // 2)).dictionary_encode(),
        "bytes": pyarrow.array([b"\x00"] * ROWS),
        "struct": pyarrow.array([{"a": 1}] * ROWS),
    }
    return [
        _parquet_bytes(columns, compression="none", use_dictionary=False),
        _parquet_bytes(columns, compression="snappy"),
        _parquet_bytes(columns, compression="gzip", data_page_version="2.0", row_group_size=10),
        _parquet_bytes(stamped, compression="none"),
        _parquet_bytes(odd, compression="none", write_page_checksum=True),
    ]


def _parquet(rng: np.random.Generator) -> Input:
    files = _parquet_files()
    if rng.random() < 0.3:
        columns: dict[str, Any] = dict(strange_columns(rng))
        for name in list(columns):
            if rng.random() < 0.1:
                columns[name] = [str(rng.choice(CELLS)) for _ in columns[name]]
        return Input("run.parquet", _parquet_bytes(columns))
    return Input("run.parquet", damaged(files[rng.integers(len(files))], files, rng))


TARGETS = (
    Target("csv", _csv, read, _csv_seeds),
    Target("parquet", _parquet, read, seeds_of("run.parquet", _parquet_files)),
)
