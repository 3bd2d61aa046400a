// Plots in the page's colours, and the recording behind a point.
'use strict';
const shown = document.getElementById('recording');
const dark = matchMedia('(prefers-color-scheme: dark)'), printed = matchMedia('print'), narrow = matchMedia('(max-width: 640px)');
const DARK = {'#222222': '#e4e8ec', '#52606d': '#a3adb8', '#5b6770': '#a9b4bf', '#0072b2': '#56b4e9', '#d55e00': '#ff9f40',
  '#7b8794': '#8f9ba8', '#2f7d4f': '#6fcf97', '#9b1c1c': '#ff7b72', '#8b2c5b': '#e58bb8'};
const colour = name => dark.matches && !printed.matches ? DARK[name] || name : name;
const own = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function dress(plot) {
  if (!plot.given) plot.given = plot.data.map(t => ({marker: t.marker && t.marker.color, line: t.line && t.line.color,
    text: t.error_y && t.marker && t.marker.color}));
  plot.given.forEach((g, i) => {
    const wanted = {};
    if (g.marker) wanted['marker.color'] = colour(g.marker);
    if (g.text) wanted['error_y.color'] = colour(g.text);
    if (g.line) wanted['line.color'] = colour(g.line);
    if (Object.keys(wanted).length) Plotly.restyle(plot, wanted, [i]);
  });
  const layout = {paper_bgcolor: 'rgba(0,0,0,0)', plot_bgcolor: 'rgba(0,0,0,0)', 'font.color': own('--ink'),
    'margin.l': narrow.matches ? 62 : 95, 'margin.r': narrow.matches ? 8 : 20,
    'hoverlabel.bgcolor': own('--card'), 'hoverlabel.font.color': own('--ink')};
  for (const axis of Object.keys(plot.layout).filter(k => /^[xy]axis\d*$/.test(k)))
    Object.assign(layout, {[axis + '.gridcolor']: own('--line'), [axis + '.zerolinecolor']: own('--line'),
      [axis + '.linecolor']: own('--line')});
  if (!plot.drawn) plot.drawn = {shapes: JSON.stringify(plot.layout.shapes || []), notes: JSON.stringify(plot.layout.annotations || [])};
  const again = text => JSON.parse(text, (key, value) => key === 'color' ? colour(value) : value);
  Plotly.relayout(plot, {...layout, shapes: again(plot.drawn.shapes), annotations: again(plot.drawn.notes)});
}
function everything() { document.querySelectorAll('.js-plotly-plot').forEach(dress); }

function show(id) {
  const r = RECORDINGS[id];
  if (!r) return;
  shown.innerHTML = '<h2></h2><p class="other"><a></a></p><div id="curves" class="plotly-graph-div"></div>';
  shown.querySelector('h2').textContent = r.title;
  const link = shown.querySelector('a');
  link.textContent = r.path; link.href = r.link;
  const lines = [
    ['measured', r.curves.measured, 'y', '#222222', 'solid'], ['command', r.curves.command, 'y2', '#5b6770', 'solid'],
    ['left by the nominal model', r.curves.nominal, 'y3', '#0072b2', 'solid'], [`left ${r.best}`, r.curves.best, 'y3', '#d55e00', 'solid']];
  const axis = (title, from, to) => ({title: {text: title, font: {size: 11}}, domain: [from, to]});
  Plotly.newPlot('curves', lines.filter(l => l[1]).map(l => ({x: r.curves.time, y: l[1], name: l[0], yaxis: l[2],
    mode: 'lines', line: {color: l[3], width: 1.4, shape: l[2] == 'y2' ? 'hv' : 'linear'}})), {
    height: narrow.matches ? 560 : 480, margin: {l: 80, r: 20, t: 10, b: 45}, hovermode: 'x unified',
    legend: {orientation: 'h', y: 1.02, yanchor: 'bottom', x: 0}, xaxis: {title: {text: 'time [s]'}, anchor: 'y3'},
    yaxis: axis(r.axis, 0.70, 1), yaxis2: axis('command [V]', 0.42, 0.64), yaxis3: axis('left / noise', 0, 0.36)},
    {displaylogo: false, responsive: true});
  dress(document.getElementById('curves'));
  shown.scrollIntoView({behavior: 'smooth', block: 'nearest'});
}
window.plotlyReady.then(() => {
  everything();
  for (const query of [dark, printed, narrow]) query.addEventListener('change', everything);
  document.querySelectorAll('.js-plotly-plot').forEach(plot => plot.on('plotly_click', event => {
    const id = event.points[0].customdata;
    if (id) show(id);
  }));
  document.querySelectorAll('a[data-id]').forEach(a => a.addEventListener('click', e => {
    e.preventDefault();
    show(a.dataset.id);
  }));
});
