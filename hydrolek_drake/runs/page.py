"""A run as one HTML file that needs no network."""

import html

from hydrolek_drake.replay.display import display_factor, display_unit
from hydrolek_drake.replay.page import STYLE
from hydrolek_drake.replay.plots_html import plots_html
from hydrolek_drake.runs.panels import full
from hydrolek_drake.runs.running import ScenarioRun
from hydrolek_drake.runs.summary import SETTLING, JointSummary, sentence

_TITLES = (
    "joint",
    "start",
    "end",
    "lowest",
    "highest",
    "range",
    "highest pressure",
    "at the stops",
    "at rest",
)


def page(done: ScenarioRun, joints: tuple[JointSummary, ...], with_replay: bool) -> str:
    """The sentence first, then numbers per joint, then the plots."""
    scenario = done.scenario
    title = f"{scenario.name}: {scenario.title}"
    links = ["<a href='signals.parquet'>signals.parquet</a>", "<a href='signals.png'>signals.png</a>"]
    if with_replay:
        links.insert(0, "<a href='replay3d.html'>3-D replay</a>")
    return "\n".join(
        [
            f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
            f"<style>{STYLE}</style></head><body><h1>{html.escape(title)}</h1>",
            f"<p class='sentence'>{html.escape(sentence(done, joints))}</p>",
            f"<p class='other'>{' &middot; '.join(links)} &middot; {_steps(done)}</p>",
            "<h2>Joints</h2>",
            _table(joints),
            f"<p class='other'>At rest: largest movement from {SETTLING:g} s after the last command has arrived "
            "to the end, with the valve closed: creep and what the other joints shake.</p>",
            "<h2>Over time</h2>",
            plots_html(full(done)),
            "</body></html>",
        ]
    )


def _steps(done: ScenarioRun) -> str:
    sizes = done.scenario.sizes
    return f"{sizes.integrator.replace('_', ' ')} at {1e3 * sizes.step:g} ms"


def _table(joints: tuple[JointSummary, ...]) -> str:
    rows = ["<tr>" + "".join(f"<th class='wide'>{title}</th>" for title in _TITLES) + "</tr>"]
    for joint in joints:
        factor, unit = display_factor(joint.unit), display_unit(joint.unit)
        positions = (joint.start, joint.end, joint.lowest, joint.highest, joint.range)
        cells = [
            html.escape(joint.joint),
            *(f"{round(factor * value, 2) + 0.0:.2f}&nbsp;{unit}" for value in positions),
            "&ndash;" if joint.pressure is None else f"{1e-6 * joint.pressure:.2f}&nbsp;MPa",
            f"{joint.at_stops:.2f}&nbsp;s" if joint.at_stops > 0.0 else "never",
            "&ndash;" if joint.rest_movement is None else f"{factor * joint.rest_movement:.4f}&nbsp;{unit}",
        ]
        rows.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    return f"<table>{''.join(rows)}</table>"
