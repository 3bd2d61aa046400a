"""What a comparison leaves in its folder: page with tables and plots, pictures, numbers."""

import base64
import html
import json
from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Any

from hydrolek_drake import __version__
from hydrolek_drake.control.bench import Bench, Trial
from hydrolek_drake.control.bench_tables import MEASURES, printed, ranking_rows, rows, sentence, tool_rows
from hydrolek_drake.control.catalogue import CONTROLLERS
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.replay.page import STYLE
from hydrolek_drake.replay.panels import Line, Panel
from hydrolek_drake.replay.picture import plots_png
from hydrolek_drake.replay.plots_html import plots_html

_COLOURS = (
    "#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22",
    "#17becf", "#393b79", "#637939", "#000000",
)  # fmt: skip
_SET_POINT = "#9aa5b1"
_SHOWN = 4
"""Joints whose angles and voltages are plotted; the numbers tell of all."""


def write_bench(bench: Bench, folder: Path) -> Path:
    """Write `bench.html`, `bench.json` and a picture per sequence, each when complete.

    Returns:
        The page's path.

    Raises:
        InputError: the folder cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        pictures = {
            sequence: plots_png([panels(bench, sequence)], _title(bench), sequence)
            for sequence in _sequences(bench)
        }
        for sequence, picture in pictures.items():
            write_whole(folder / f"{sequence}.png", picture)
        write_whole(folder / "bench.json", json.dumps(as_json(bench), indent=1).encode())
        write_whole(folder / "bench.html", page(bench, pictures).encode())
    except OSError as error:
        raise InputError(f"--out {folder}: cannot write there: {error.strerror or error}") from None
    return folder / "bench.html"


def _sequences(bench: Bench) -> list[str]:
    return list(dict.fromkeys(trial.sequence for trial in bench.trials))


def _title(bench: Bench) -> str:
    plant = (
        "SDP models, joints 1 to 4 of the right arm" if bench.plant == "sdp" else "full machine, both arms"
    )
    return f"Controllers compared on {plant}"


def panels(bench: Bench, sequence: str) -> list[Panel]:
    """Angle and voltage of the first joints, one line per controller."""
    trials = [trial for trial in bench.trials if trial.sequence == sequence]
    joints = list(trials[0].joints)[:_SHOWN]
    stack = []
    for i, joint in enumerate(joints):
        lines = [Line("set point", trials[0].time_s, trials[0].set_point_deg[:, i], _SET_POINT, stepped=True)]
        lines += [_line(trial, trial.angle_deg[:, i], stepped=False) for trial in trials]
        stack.append(Panel(f"{joint} [deg]", tuple(lines), (), None, 2.0))
    for i, joint in enumerate(joints):
        # without scaling the voltage swings between its limits and hides all others
        calm = [trial for trial in trials if trial.controller != "pip_no_scaling"] or trials
        drawn = tuple(_line(trial, trial.voltage_V[:, i], stepped=True) for trial in calm)
        stack.append(Panel(f"{joint} [V]", drawn, (), None, 1.2))
    return stack


def _line(trial: Trial, values: Any, *, stepped: bool) -> Line:
    place = list(CONTROLLERS).index(trial.controller)
    colour = _COLOURS[place % len(_COLOURS)]
    return Line(CONTROLLERS[trial.controller][0], trial.time_s, values, colour, stepped=stepped)


def page(bench: Bench, pictures: Mapping[str, bytes]) -> str:
    """One HTML file that needs no network: the sentence, the ranking, tables, plots.

    The first sequence's plot can be zoomed; the others are pictures, which keeps the page small.
    """
    title = _title(bench)
    brackets = " In brackets: what the thesis prints (appendix G, Table 6.9)." if bench.plant == "sdp" else ""
    parts = [
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
        f"<style>{STYLE}</style></head><body><h1>{html.escape(title)}</h1>",
        f"<p class='sentence'>{html.escape(sentence(bench))}</p>",
        f"<p class='other'>Variances are those of control samples, 0.05 s apart.{brackets}"
        f"{' The comparison was interrupted: what is missing was not run.' if bench.interrupted else ''}</p>",
        *(f"<p class='other'>failed: {html.escape(said)}</p>" for said in bench.failed),
        "<h2>Objectives of chapter 6, step</h2>",
        _table(*ranking_rows(bench)),
    ]
    for sequence in _sequences(bench):
        parts.append(f"<h2>{sequence}</h2>")
        for measure in MEASURES:
            if sequence in measure.sequences:
                parts += [
                    f"<p class='other'>{html.escape(measure.title)}</p>",
                    _table(*rows(bench, sequence, measure)),
                ]
        parts += ["<p class='other'>end effector</p>", _table(*tool_rows(bench, sequence))]
        if sequence == _sequences(bench)[0]:
            parts.append(plots_html([panels(bench, sequence)]))
        else:
            data = base64.b64encode(pictures[sequence]).decode()
            parts.append(f"<img alt='{sequence}' style='max-width:100%' src='data:image/png;base64,{data}'>")
    return "\n".join([*parts, "</body></html>"])


def _table(head: list[str], body: list[list[str]]) -> str:
    if not head:
        return "<p class='other'>not run</p>"
    titles = "".join(f"<th class='wide'>{html.escape(cell)}</th>" for cell in head)
    lines = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in line) + "</tr>" for line in body
    )
    return f"<table><tr>{titles}</tr>{lines}</table>"


def as_json(bench: Bench) -> dict[str, Any]:
    """All numbers; what is not finite is null."""
    return {
        "schema": 1,
        "version": __version__,
        "plant": bench.plant,
        "interrupted": bench.interrupted,
        "failed": bench.failed,
        "sentence": sentence(bench),
        "trials": [
            {
                "controller": trial.controller,
                "sequence": trial.sequence,
                "euclidean_mm": trial.euclidean_mm,
                "tool_variance_mm2": trial.tool_variance_mm2,
                "joints": {
                    joint: {
                        measure.key: {
                            "value": _finite(measure.value(measures)),
                            "thesis": _finite(printed(trial.sequence, trial.controller, measure.key, joint))
                            if bench.plant == "sdp"
                            else None,
                        }
                        for measure in MEASURES
                        if trial.sequence in measure.sequences
                    }
                    for joint, measures in trial.joints.items()
                },
            }
            for trial in bench.trials
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if isfinite(value) else None
