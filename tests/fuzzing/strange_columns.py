"""Columns of a recording as they should be, and with names, cells and values that nobody meant."""

import numpy as np

ROWS = 40
_NAMES = (
    "time_s", "time_ms", "time", "t", "q", "u", "j.command_V", "j.angle_deg", "j.angle_rad", "j.angle",
    "j.pressure_a_MPa", "supply.pressure_bar", "j.effort_Nm", "j.force_1", "j.command_percent",
    "j.angle_deg_per_s", "k.position_mm", "x", "", " ", ".", "j.", ".angle_deg", "j..angle_deg",
    "j.angle_m^9^9", "j.angle_9**9**9", "j.command_V/V*V", "a" * 300, "é.angle_deg", "j.angle_(deg",
    "j.angle_\x00deg", "a,b.angle_deg", "=j.angle_deg", '"', "=1+1", "time_parsec", "time_s ", "TIME_S",
    "j.reference_V", "j.pot_1",
)  # fmt: skip
CELLS = (
    "", " ", "0", "1", "-1", "1e300", "-1e300", "1e999", "nan", "NaN", "inf", "-inf", "1,5", "1.5", "1;2", "x",
    "1_0", "0x10", "٣", "1e", ".", "-", "+", "1 2", '"', '"1"', "'1", "1" * 400, "\x00", "é", "=1+1", "#",
    "# 1", "1e-320", "TRUE", "None", "2026-11-27T12:00:00", "12:00:00", "\t", "1\r2", "\u2028", "\ufeff1", "−1",
    "1 ", "01.02.2024",
)  # fmt: skip


def good_columns(rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Time, command, angle and pressure of a joint, each of shape (40,)."""
    time = 12.5 + np.cumsum(rng.uniform(0.0095, 0.0105, ROWS))
    return {
        "time_s": time,
        "j.command_V": np.sign(np.sin(3 * time)) * 4.25,
        "j.angle_deg": 25 + 10 * np.sin(time),
        "j.pressure_a_MPa": 5 + np.cos(2 * time),
    }


def _strange_values(rng: np.random.Generator, rows: int) -> np.ndarray:
    """Numbers that a column may hold, of any type that NumPy has for them."""
    edges = [0.0, -0.0, 1.0, -1.0, 1e300, -1e300, 5e-324, np.inf, -np.inf, np.nan, 2.0**53, 1e-9]
    match rng.integers(8):
        case 0:
            return rng.choice(edges, rows)
        case 1:
            return np.full(rows, rng.choice(edges))
        case 2:
            return rng.integers(-(2**62), 2**62, rows)
        case 3:
            return rng.integers(0, 2, rows).astype(bool)
        case 4:
            return np.sort(rng.choice(edges[:7], rows))
        case 5:
            return np.cumsum(rng.uniform(-0.1, 1.0, rows)).astype(rng.choice(["f4", "f2", "i1", "u8", "i4"]))
        case 6:
            return np.arange(rows)[:: int(rng.choice([-1, 1]))]
        case _:
            return rng.normal(size=rows) * 10.0 ** rng.uniform(-300, 300)


def strange_columns(rng: np.random.Generator, *, alike: bool = True) -> dict[str, np.ndarray]:
    """Columns with names and values that nobody meant; with some that are good, as often as not."""
    rows = int(rng.choice([0, 1, 2, 3, ROWS]))
    good = good_columns(rng) if rng.random() < 0.8 else {}
    columns = {name: values[:rows] for name, values in good.items() if rng.random() < 0.8}
    for _ in range(rng.integers(0, 4)):
        own = rows if alike or rng.random() < 0.7 else int(rng.integers(0, 50))
        columns[str(rng.choice(_NAMES))] = _strange_values(rng, own)
    for name in list(columns):
        if rng.random() < 0.15:
            columns[name] = _strange_values(rng, rows)
    return columns
