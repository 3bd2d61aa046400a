"""Plotly in a page that needs no network: its program packed to a third of its size, and figures as data."""

import base64
import gzip
import html
from typing import Any

_DRAW = """
window.plotlyReady ||= (async () => {
  const bytes = Uint8Array.from(atob(document.getElementById('plotly-packed').textContent), c => c.charCodeAt(0));
  const script = document.createElement('script');
  script.textContent = await new Response(
    new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).text();
  document.head.append(script);
  for (const given of document.querySelectorAll('script[data-figure]')) {
    const figure = JSON.parse(given.textContent);
    const plot = given.previousElementSibling;
    await Plotly.newPlot(plot, figure.data, figure.layout, {displaylogo: false, responsive: true});
  }
})();
window.plotlyReady.catch(error => {
  for (const plot of document.querySelectorAll('.plotly-graph-div'))
    plot.textContent = `Plots need a browser of 2023 or later (${error}).`;
});
"""


def packed_plotly() -> str:
    """The program, once a page, below its figures; `plotlyReady` is fulfilled when these are drawn."""
    from plotly.offline import get_plotlyjs

    packed = base64.b64encode(gzip.compress(get_plotlyjs().encode(), mtime=0)).decode("ascii")
    return f"<script id='plotly-packed' type='application/octet-stream'>{packed}</script><script>{_DRAW}</script>"


def figure_html(figure: Any, name: str = "plot") -> str:
    """Where a figure is drawn, and its data.

    Args:
        figure: of Plotly.
        name: that screen readers tell.
    """
    height = f"height: {figure.layout.height:g}px" if figure.layout.height else ""
    data = figure.to_json().replace("</", "<\\/")
    return (
        f"<div class='plotly-graph-div' style='{height}' role='img' aria-label='{html.escape(name, quote=True)}'></div>"
        f"<script type='application/json' data-figure>{data}</script>"
    )
