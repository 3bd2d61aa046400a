"""Pictures of a watch: sizes over time with trend and limits, and what models leave."""

from collections.abc import Sequence
from datetime import datetime, timezone
from typing import Any

import numpy as np

from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.replay.display import display_factor, display_unit, shown
from hydrolek_drake.watching.asking import OWN_NUMBERS
from hydrolek_drake.watching.limits import Limit
from hydrolek_drake.watching.trends import reached
from hydrolek_drake.watching.watch import Watched

SIZE_COLOUR, REFERENCE_COLOUR, BEYOND_COLOUR = "#0072b2", "#7b8794", "#d55e00"
TREND_COLOUR, LIMIT_COLOUR, WITH_COLOUR = "#2f7d4f", "#9b1c1c", "#8b2c5b"
"""Told apart also by who does not see red or green (Okabe, Ito, Color Universal Design, 2008); the page has a lighter
one of each where it is dark."""

AHEAD = 0.6
"""Without a limit that is reached sooner a forecast is drawn over this share of the time that was watched."""


def size_figure(watched: Watched, effect: str, joint: str, limits: Sequence[Limit] = ()) -> Any:
    """One effect's size over time with 95 % intervals, change points, trend and limits, as a Plotly figure.

    Each point carries the hash of its recording as `customdata`.

    Args:
        watched: the outcome.
        effect: id.
        joint: where it acts.
        limits: of this effect or others, which are left out.
    """
    from plotly.graph_objects import Figure, Scatter

    figure: Any = Figure()
    unit = ""
    beyond = {
        each.digest: effect in judgement.beyond
        for each, judgement in zip(watched.asked, watched.judgements, strict=True)
    }
    for name, group, colour, symbol in (
        ("reference", watched.reference, REFERENCE_COLOUR, "square"),
        (
            "within what chance gives",
            [s for s in watched.asked if not beyond[s.digest]],
            SIZE_COLOUR,
            "circle",
        ),
        ("beyond the threshold", [s for s in watched.asked if beyond[s.digest]], BEYOND_COLOUR, "diamond"),
    ):
        rows = [
            (each, told)
            for each in group
            if each.answer is not None
            for told in each.answer.effects
            if (told.effect, told.joint) == (effect, joint)
        ]
        rows = [(each, told) for each, told in rows if np.isfinite([told.size, told.low, told.high]).all()]
        if not rows:
            continue
        unit = rows[0][1].unit
        factor = display_factor(unit)
        figure.add_trace(
            Scatter(
                x=[_moment(each.stamp.seconds) for each, _ in rows],
                y=[factor * told.size for _, told in rows],
                error_y={
                    "type": "data",
                    "symmetric": False,
                    "array": [factor * (told.high - told.size) for _, told in rows],
                    "arrayminus": [factor * (told.size - told.low) for _, told in rows],
                    "thickness": 1.2,
                    "width": 3,
                },
                mode="markers",
                marker={"color": colour, "size": 8, "symbol": symbol},
                name=name,
                customdata=[each.digest for each, _ in rows],
                text=[each.recording for each, _ in rows],
                hovertemplate="%{text}<br>%{x}<br>%{y:.4g}<extra></extra>",
            )
        )
    own = [limit for limit in limits if limit.effect == effect]
    factor = display_factor(unit) if unit else 1.0
    until = _draw_trend(figure, Scatter, watched, effect, joint, own, factor)
    for limit in own:
        figure.add_hline(
            y=factor * limit.size, line={"color": LIMIT_COLOUR, "dash": "dash", "width": 1.2},
            annotation_text=f"limit {shown(limit.size, unit or '1')}", annotation_font_color=LIMIT_COLOUR,
            annotation_position="bottom left",
        )  # fmt: skip
    name = EFFECTS[effect].title if effect in EFFECTS else "largest change"
    axis = f"{name}{'' if unit in ('', '1') else f' [{display_unit(unit)}]'}"
    _dress(figure, _wrapped(axis), 330)
    if watched.asked:
        figure.update_xaxes(range=[_moment(each) for each in _span(watched, until)])
    return figure


def _wrapped(axis: str) -> str:
    return axis.replace(" [", "<br>[")


def _draw_trend(
    figure: Any,
    scatter: Any,
    watched: Watched,
    effect: str,
    joint: str,
    limits: Sequence[Limit],
    factor: float,
) -> float:
    """The last piece's line with its band, extrapolated, and where the course changed; until when [s since 1970]."""
    end = watched.asked[-1].stamp.seconds if watched.asked else 0.0
    if effect == OWN_NUMBERS:
        return end
    trend = watched.trend(effect, joint)
    for change in trend.changes:
        figure.add_vline(x=_moment(change), line={"color": "#52606d", "dash": "dot", "width": 1.2})
    if trend.last is None or not trend.moves:
        return end
    first, last = trend.begins, trend.last.origin
    until = last + AHEAD * (last - watched.asked[0].stamp.seconds)
    for limit in limits:
        when = reached(trend.last, limit.size)
        if np.isfinite(when.likeliest):
            until = min(max(until, when.likeliest), last + 5.0 * (last - first + 1.0))
    times = np.linspace(first, until, 60)
    values, half = trend.last.at(times)
    moments = [_moment(each) for each in times]
    figure.add_trace(
        scatter(
            x=[*moments, *reversed(moments)],
            y=[*(factor * (values + half)), *reversed(factor * (values - half))],
            fill="toself",
            fillcolor="rgba(47,125,79,0.18)",
            line={"width": 0},
            name="trend, 95 %",
            hoverinfo="skip",
        )
    )
    figure.add_trace(
        scatter(
            x=moments,
            y=factor * values,
            mode="lines",
            line={"color": TREND_COLOUR, "width": 1.4},
            name="trend",
            hoverinfo="skip",
        )
    )
    return float(until)


def _span(watched: Watched, until: float) -> tuple[float, float]:
    """Time that is drawn [s since 1970]: the later recordings, a forecast, and reference recordings not long before."""
    first, last = watched.asked[0].stamp.seconds, watched.asked[-1].stamp.seconds
    length = max(last - first, 1.0)
    near = [each.stamp.seconds for each in watched.reference if 0.0 <= first - each.stamp.seconds <= length]
    begin, end = min([first, *near]), max(last, until)
    margin = 0.04 * (end - begin) or 1.0
    return begin - margin, end + margin


def left_figure(watched: Watched) -> Any:
    """Times the noise that the nominal model leaves, and the best single effect, over time."""
    from plotly.graph_objects import Figure, Scatter

    figure: Any = Figure()
    asked = [(each, each.answer) for each in watched.asked if each.answer is not None]
    moments = [_moment(each.stamp.seconds) for each, _ in asked]
    ids = [each.digest for each, _ in asked]
    for name, values, colour in (
        ("nominal model", [answer.left for _, answer in asked], SIZE_COLOUR),
        ("with the best effect", [min(e.left for e in answer.effects) for _, answer in asked], WITH_COLOUR),
    ):
        figure.add_trace(
            Scatter(
                x=moments,
                y=values,
                mode="lines+markers",
                name=name,
                customdata=ids,
                line={"color": colour, "width": 1.2},
                text=[each.recording for each, _ in asked],
                hovertemplate="%{text}<br>%{x}<br>%{y:.4g}<extra></extra>",
            )
        )
    figure.add_trace(
        Scatter(
            x=moments,
            y=[judgement.most_left for judgement in watched.judgements],
            mode="lines",
            name="threshold",
            line={"color": LIMIT_COLOUR, "dash": "dash", "width": 1.2},
            hoverinfo="skip",
        )
    )
    figure.update_yaxes(type="log" if max((a.left for _, a in asked), default=1.0) > 3.0 else "linear")
    _dress(figure, "times the noise", 260)
    return figure


def _moment(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, timezone.utc)


def _dress(figure: Any, axis: str, height: int) -> None:
    """As the other pages' plots look."""
    figure.update_yaxes(
        title_text=axis, title_font_size=11, gridcolor="#e4e9ee", zerolinecolor="#c7d0d9", exponentformat="e"
    )
    figure.update_xaxes(gridcolor="#e4e9ee")
    figure.update_layout(
        height=height,
        plot_bgcolor="white",
        margin={"l": 95, "r": 20, "t": 40, "b": 40},
        legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0},
        hovermode="closest",
    )
