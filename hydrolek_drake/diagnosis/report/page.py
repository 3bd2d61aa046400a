"""The diagnosis as one HTML file that needs no network: the verdict first, how it was computed last."""

import html
import json
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.report import sections
from hydrolek_drake.diagnosis.report.look_at import look_at
from hydrolek_drake.diagnosis.report.plot_data import plot_data
from hydrolek_drake.diagnosis.report.words import headline
from hydrolek_drake.replay.confirmation import Confirmation


def page(diagnosis: Diagnosis, confirmed: Sequence[Confirmation] = ()) -> str:
    """The whole page.

    Args:
        diagnosis: the outcome.
        confirmed: the fitted rig on the Drake Diagram, where that was run.
    """
    title = f"Diagnosis of {diagnosis.rig.name}"
    look = look_at(diagnosis)
    line = f"<p class='look'><b>What to look at:</b> {html.escape(look)}</p>" if look else ""
    parts = [
        f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
        "<meta name='viewport' content='width=device-width, initial-scale=1'>"
        f"<style>{_asset('uPlot.min.css')}\n{_asset('report.css')}</style></head><body>",
        f"<h1>{html.escape(title)}</h1>",
        f"<div class='verdict' style='--verdict: var(--{diagnosis.verdict})'><b>"
        f"{diagnosis.verdict.replace('_', ' ')}</b><p class='sentence'>{html.escape(headline(diagnosis))}</p>"
        f"{line}</div>",
    ]
    if diagnosis.verdict == "bad_data":
        parts += [
            f"<ul>{''.join(f'<li>{html.escape(r)}</li>' for r in diagnosis.reasons)}</ul></body></html>"
        ]
        return "\n".join(parts)
    data = plot_data(diagnosis)
    if diagnosis.reasons:
        parts.append(f"<ul>{''.join(f'<li>{html.escape(r)}</li>' for r in diagnosis.reasons)}</ul>")
    parts += [
        sections.effects(diagnosis),
        sections.fit(diagnosis),
        *(f"<p>{html.escape(each.sentence())}</p>" for each in confirmed),
        "<h2>Measured, before and after</h2>",
        _plots(diagnosis, data),
        "<h2>Where and when</h2>",
        sections.locations(diagnosis),
        sections.unknown(diagnosis),
        "<h2>Models compared on the held-out data</h2>",
        sections.candidates(diagnosis),
        "<h2>Parameters</h2>",
        sections.parameters(diagnosis),
        "<h2>What these data cannot tell apart</h2>",
        sections.groups(diagnosis),
        "<h2>What would have been seen</h2>",
        sections.visible(diagnosis),
        "<h2>Next experiment</h2>",
        f"<p class='other'>{html.escape(sections.proposed(diagnosis))}</p>",
        "<h2>How it was computed</h2>",
        sections.method(diagnosis),
        _scripts(diagnosis, data),
        "</body></html>",
    ]
    return "\n".join(parts)


def _asset(name: str) -> str:
    return files(__package__).joinpath("assets", name).read_text(encoding="utf-8")


def _plots(diagnosis: Diagnosis, data: dict[str, Any]) -> str:
    """Where the script draws, with what can be moved and what the colours mean."""
    grown = any(r["grown"] for r in data["recordings"])
    held = any(r["held"] for r in data["recordings"])
    keys = [_key("grown", "the mismatch grows most here")] if grown else []
    keys += [_key("held", "held out, not fitted")] if held else []
    keys.append(_key("band", "three times the noise"))
    every = max(c["every"] for r in data["recordings"] for c in r["charts"])
    thinned = (
        f" Of each {every} samples or so those with the smallest and largest values are drawn."
        if every > 1
        else ""
    )
    how = (
        "Drag across a plot to zoom all of its recording; a double click, or 'all', shows the whole. Residuals are "
        f"drawn to scale up to the noise and by powers of ten beyond it.{thinned}"
    )
    arm = ""
    if data["arm"]:
        moving = " and ".join(data["arm"]["recordings"][0])
        arm = (
            "<div class='arm'><canvas id='arm' role='img' aria-label='the arm as it was measured'></canvas>"
            f"<p class='other'><span id='arm-says'></span>. The arm at the moment under the cursor: {moving} as "
            "measured, its other joints where the rig holds them, the model's links as outlines. Drag to turn it.</p>"
            "</div>"
        )
    return (
        _controls(data)
        + arm
        + f"<p class='other'>{''.join(keys)}</p><p class='other'>{how}</p><div class='columns' id='recordings'></div>"
    )


def _key(colour: str, meaning: str) -> str:
    return f"<span class='key' style='background: var(--{colour})'></span>{meaning}"


def _controls(data: dict[str, Any]) -> str:
    """The slider that fades what was found; nothing where nothing can be faded."""
    if not data["fadings"]:
        return ""
    titles = [html.escape(each["title"]) for each in data["fadings"]]
    chosen = (
        "<select id='faded' aria-label='what is faded'>"
        + "".join(f"<option value='{i}'>{title}</option>" for i, title in enumerate(titles))
        + "</select>"
        if len(titles) > 1
        else f"<span>{titles[0]}</span>"
    )
    return (
        f"<div class='controls'><label for='share'>Fade</label>{chosen}<input type='range' id='share' min='0' "
        "max='100' value='100' aria-label='share of its size'><output id='percent' for='share'>100 %</output>"
        "<button id='play' type='button'>out and in</button></div>"
    )


def _scripts(diagnosis: Diagnosis, data: dict[str, Any]) -> str:
    """The library that draws with its licence, the data, and the page's own script."""
    found = "with the law found" if diagnosis.law is not None else "with the missing physics"
    more = bool(diagnosis.best.hypothesis.effects) or diagnosis.law is not None
    given = json.dumps(data, allow_nan=False).replace("</", "<\\/")
    return (
        f"<script>/*\n{_asset('uPlot.LICENSE')}*/\n{_asset('uPlot.iife.min.js')}</script>\n"
        f"<script>const DATA = {given};\nconst FOUND = {json.dumps(found if more else '')};\n"
        f"{_asset('arm.js')}\n{_asset('report.js')}\nbegun();</script>"
    )
