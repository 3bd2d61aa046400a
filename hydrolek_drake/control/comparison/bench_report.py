"""What a comparison leaves in its folder: page with tables and plots, pictures, numbers."""

import base64
import html
import json
from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Any

from hydrolek_drake import __version__
from hydrolek_drake.control.catalogue import CONTROLLERS
from hydrolek_drake.control.comparison.bench import Bench, Trial
from hydrolek_drake.control.comparison.bench_pictures import fuzzy_pictures, paths_png
from hydrolek_drake.control.comparison.bench_tables import MEASURES, ranking_rows, rows, sentence, tool_rows
from hydrolek_drake.control.comparison.thesis_tables import printed
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.replay.page import STYLE
from hydrolek_drake.replay.panels import Line, Panel
from hydrolek_drake.replay.picture import plots_png
from hydrolek_drake.replay.plots_html import plots_html

_COLOURS = (
    "#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22",
    "#17becf", "#393b79", "#637939", "#8c6d31", "#ad494a", "#000000",
)  # fmt: skip
_SET_POINT = "#9aa5b1"
_SHOWN = 4
"""Joints whose angles and voltages are plotted; the numbers tell of all."""

_BRACKETS = {
    "sdp": "In brackets: what the thesis prints for the same models (Tables G.1 to G.6, 6.9 to 6.11); j4 linear is "
    "joint 4 with the linear law of Table 6.7. The grasp's set points are reconstructed.",
    "full": "In brackets: what the thesis measured on its machine (Tables 7.3 to 7.5, G.7 to G.11), right joints "
    "1 to 4, means of three runs; 'linear' is joint 4 with the controller for the linear model. To be compared are "
    "orders of size and which controller does better. The values themselves are another machine's: its valve and "
    "its flows are not printed, only the four joints moved that were tested, sine and grasp are reconstructed, and "
    "the noise here is that of the rig's potentiometers.",
}


def write_bench(bench: Bench, folder: Path) -> Path:
    """Write `bench.html`, `bench.json` and pictures, each when complete.

    Pictures: the signals and the wrist's path of each sequence (figures 5.9, 6.27, 7.11), and the sets and control
    surface of every fuzzy controller that was run (figures 7.3, 7.4, 7.6, appendix F).

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
        more = {f"{name}_path.png": paths_png(bench, name, _colours()) for name in _sequences(bench)}
        more |= fuzzy_pictures(bench)
        for name, picture in ({f"{key}.png": value for key, value in pictures.items()} | more).items():
            write_whole(folder / name, picture)
        write_whole(folder / "bench.json", json.dumps(as_json(bench), indent=1).encode())
        write_whole(folder / "bench.html", page(bench, pictures, more).encode())
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
    colour = _colours()[trial.controller]
    return Line(CONTROLLERS[trial.controller][0], trial.time_s, values, colour, stepped=stepped)


def _colours() -> dict[str, str]:
    return {name: _COLOURS[place % len(_COLOURS)] for place, name in enumerate(CONTROLLERS)}


def page(bench: Bench, pictures: Mapping[str, bytes], more: Mapping[str, bytes] | None = None) -> str:
    """One HTML file that needs no network: the sentence, the ranking, tables, plots.

    The first sequence's plot can be zoomed; the others are pictures, which keeps the page small.

    Args:
        bench: results.
        pictures: sequence -> picture of its signals.
        more: name of a file -> picture: paths of the wrist stand with their sequence, the rest at the end.
    """
    more = dict(more or {})
    title = _title(bench)
    parts = [
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
        f"<style>{STYLE}</style></head><body><h1>{html.escape(title)}</h1>",
        f"<p class='sentence'>{html.escape(sentence(bench))}</p>",
        f"<p class='other'>Variances are those of control samples, 0.05 s apart. {html.escape(_BRACKETS[bench.plant])}"
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
            parts.append(_image(sequence, pictures[sequence]))
        path = f"{sequence}_path.png"
        if path in more:
            parts.append(_image(path, more.pop(path)))
    if more:
        parts += ["<h2>Fuzzy controllers</h2>", *(_image(name, picture) for name, picture in more.items())]
    return "\n".join([*parts, "</body></html>"])


def _image(name: str, picture: bytes) -> str:
    data = base64.b64encode(picture).decode()
    return f"<img alt='{html.escape(name)}' style='max-width:100%' src='data:image/png;base64,{data}'>"


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
                            "thesis": _finite(
                                printed(bench.plant, trial.sequence, trial.controller, measure.key, joint)
                            ),
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
