'use strict';
// Signals, residuals, command and unknown input over one time for each recording; the effect faded; the cursor shared.
const floats = text => {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return Array.from(new Float32Array(bytes.buffer), v => Number.isNaN(v) ? null : v);
};
const colour = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const told = (v, unit) => v == null ? '–' : `${Number(v.toPrecision(4))} ${unit}`;
const state = {choice: 0, share: 1, time: DATA.recordings.map(r => r.begin), groups: [], arm: null};

for (const r of DATA.recordings) {
  for (const c of r.charts) {
    for (const key of ['x', 'measured', 'before', 'after']) c[key] = floats(c[key]);
    c.faded = c.faded.map(course => course.map(floats));
  }
  for (const c of [r.command, ...r.unknown]) for (const key of ['x', 'y', 'wide']) if (c[key]) c[key] = floats(c[key]);
}

// the model with the effect at a share of its size, on a straight line between the shares that were rolled out
function modelled(chart) {
  const course = chart.faded[state.choice];
  if (!course || state.share >= 1) return chart.after;
  const place = state.share * (DATA.shares.length - 1), first = Math.floor(place), rest = place - first;
  const low = course[first], high = course[Math.min(first + 1, course.length - 1)];
  return low.map((v, i) => v == null || high[i] == null ? null : v + rest * (high[i] - v));
}
const less = (a, b) => a.map((v, i) => v == null || b[i] == null ? null : v - b[i]);

function linked(group, u) {
  const {min, max} = u.scales.x;
  group.shown = {min, max};
  for (const other of group.plots)
    if (other !== u && (other.scales.x.min !== min || other.scales.x.max !== max)) other.setScale('x', {min, max});
}

function shading(recording, band) {
  return u => {
    const {ctx, bbox} = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const [spans, name] of [[recording.held, 'held'], [recording.grown, 'grown']]) {
      ctx.fillStyle = colour(name);
      for (const [begin, end] of spans) {
        const from = u.valToPos(begin, 'x', true), to = u.valToPos(end, 'x', true);
        ctx.fillRect(from, bbox.top, Math.max(to - from, 1), bbox.height);
      }
    }
    if (band) {
      const low = u.valToPos(-band, 'y', true), high = u.valToPos(band, 'y', true);
      ctx.fillStyle = colour('band');
      ctx.fillRect(bbox.left, high, bbox.width, low - high);
    }
    ctx.restore();
  };
}

function plot(group, recording, name, unit, height, data, series, more = {}) {
  const box = document.createElement('div'), title = document.createElement('div');
  box.className = 'chart';
  title.className = 'name';
  title.textContent = `${name} [${unit}]`;
  box.append(title);
  group.box.append(box);
  box.classList.toggle('unknown', Boolean(more.bands));
  const axis = {stroke: colour('quiet'), grid: {stroke: colour('line'), width: 1}, ticks: {stroke: colour('line')},
    font: '11px system-ui'};
  const u = new uPlot({
    width: Math.max(box.clientWidth, 200), height,
    scales: {x: {time: false, range: (u, low, high) => [low, high]}, y: more.scale || {}},
    series: [{label: 'time', value: (u, v) => told(v, 's')},
      ...series.map(s => ({points: {show: false}, value: (u, v) => told(v, unit), ...s}))],
    axes: [{...axis, size: 26}, {...axis, size: 62, space: 24, splits: more.splits, values: (u, ticks) => ticks.map(v => v == null ? '' :
      Math.abs(v) >= 1e5 || (v && Math.abs(v) < 1e-3) ? v.toExponential(0) : String(Number(v.toPrecision(5))))}],
    bands: more.bands,
    cursor: {y: false, drag: {x: true, y: false, dist: 5}, sync: {key: `recording${group.number}`, filters: {
      pub: type => type === 'mousemove' || type === 'mouseleave'}},
      bind: {dblclick: () => () => { whole(group); return null; }}},
    hooks: {setScale: [(u, key) => key === 'x' && u.status && group.plots.includes(u) && linked(group, u)], drawClear: [shading(recording, more.band)],
      setCursor: [u => { if (u.cursor.left >= 0) at(group.number, u.posToVal(u.cursor.left, 'x')); }]},
  }, data, box);
  u.over.addEventListener('touchmove', e => touched(u, e), {passive: true});
  u.over.addEventListener('touchstart', e => touched(u, e), {passive: true});
  u.refresh = more.refresh;
  group.plots.push(u);
  return u;
}

function touched(u, event) {
  const place = u.over.getBoundingClientRect(), finger = event.touches[0];
  u.setCursor({left: finger.clientX - place.left, top: finger.clientY - place.top}, true, true);
}

function whole(group) {
  for (const u of group.plots) u.setScale('x', {min: group.recording.begin, max: group.recording.end});
}

function zoomed(group, factor) {
  const {min, max} = group.plots[0].scales.x, {begin, end} = group.recording;
  const middle = Math.min(Math.max(state.time[group.number], min), max), half = factor * (max - min) / 2;
  const from = Math.max(begin, middle - half), to = Math.min(end, middle + half);
  for (const u of group.plots) u.setScale('x', {min: from, max: to});
}

function at(number, time) {
  state.time[number] = time;
  state.last = number;
  if (state.arm) state.arm.draw();
}

// ticks at zero and at powers of ten to either side; those nearest to zero only where there is room for them
const powers = least => (u, axis, low, high) => {
  const count = Math.ceil(Math.log10(Math.max(Math.abs(low), Math.abs(high), least) / least) + .01);
  const ticks = [];
  for (let k = count; k >= (count > 1 ? 1 : 0); k -= count > 4 ? 2 : 1) ticks.push(least * 10 ** k);
  return [...ticks.map(v => -v), 0, ...ticks.reverse()].filter(v => v >= low && v <= high);
};

function drawn() {
  const narrow = innerWidth < 640;
  for (const group of state.groups) {
    group.plots.forEach(u => u.destroy());
    group.plots = [];
    group.box.replaceChildren();
    const {recording} = group, shown = group.shown || {min: recording.begin, max: recording.end};
    const nominal = {label: 'nominal model', stroke: colour('nominal'), width: 1.5, dash: [6, 4]};
    const found = {label: FOUND, stroke: colour('found'), width: 1.6};
    for (const c of recording.charts) {
      const lines = () => [c.x, c.measured, c.before, ...(FOUND ? [modelled(c)] : [])];
      // measured lies beneath as a broad line, so that a model that follows it does not hide it
      plot(group, recording, c.name, c.unit, narrow ? 190 : 230, lines(), [
        {label: 'measured', stroke: colour('measured'), width: 6}, nominal, ...(FOUND ? [found] : [])], {refresh: lines});
      const left = () => [c.x, less(c.measured, c.before), ...(FOUND ? [less(c.measured, modelled(c))] : [])];
      const least = 10 ** Math.floor(Math.log10(c.band || 1)), scale = {distr: 4, asinh: least};
      plot(group, recording, `${c.name} less the model`, c.unit, narrow ? 150 : 170, left(), [
        {...nominal, label: 'left by the nominal model', dash: null, width: 1.2},
        ...(FOUND ? [{...found, label: `left ${FOUND}`, width: 1.2}] : [])], {refresh: left, scale, splits: powers(least), band: c.band});
    }
    plot(group, recording, 'command', 'V', narrow ? 120 : 130, [recording.command.x, recording.command.y], [
      {label: 'command', stroke: colour('command'), width: 1.4, paths: uPlot.paths.stepped({align: 1})}]);
    if (recording.unknown.length) unknown(group, recording, narrow);
    for (const u of group.plots) u.setScale('x', shown);
  }
}

function unknown(group, recording, narrow) {
  const given = recording.unknown[group.stage || 0];
  const y = given.y, wide = given.wide;
  plot(group, recording, `unknown input: ${given.stage}, ${given.name}`, given.unit, narrow ? 150 : 170,
    [given.x, y.map((v, i) => v + wide[i]), y.map((v, i) => v - wide[i]), y], [
      {label: 'and 2 standard deviations', stroke: 'transparent', width: 0},
      {label: 'less 2', stroke: 'transparent', width: 0},
      {label: 'unknown input', stroke: colour('unknown'), width: 1.6,
        value: (u, v, s, i) => v == null ? '–' : `${told(v, given.unit)} ± ${told(wide[i], '')}`}],
    {bands: [{series: [1, 2], fill: colour('band')}]});
  if (recording.unknown.length < 2) return;
  const select = document.createElement('select');
  select.setAttribute('aria-label', 'stage of the unknown input');
  recording.unknown.forEach((each, i) => select.add(new Option(`${each.stage}: ${each.name}`, i)));
  select.value = group.stage || 0;
  select.onchange = () => { group.stage = Number(select.value); drawn(); };
  group.plots[group.plots.length - 1].root.parentElement.prepend(select);
}

function refreshed() {
  for (const group of state.groups) for (const u of group.plots) if (u.refresh) {
    const {min, max} = u.scales.x;
    u.batch(() => { u.setData(u.refresh(), false); u.setScale('x', {min, max}); });
  }
  if (state.arm) state.arm.draw();
}

function begun() {
  const columns = document.getElementById('recordings');
  DATA.recordings.forEach((recording, number) => {
    const section = document.createElement('section'), head = document.createElement('h3');
    const box = document.createElement('div'), name = document.createElement('span');
    name.textContent = recording.title;
    head.append(name);
    const group = {number, recording, box, plots: []};
    for (const [text, label, act] of [['+', 'zoom in at the cursor', () => zoomed(group, .5)],
      ['−', 'zoom out', () => zoomed(group, 2)], ['all', 'the whole recording', () => whole(group)]]) {
      const button = document.createElement('button');
      button.textContent = text;
      button.title = label;
      button.setAttribute('aria-label', label);
      button.onclick = act;
      head.append(button);
    }
    section.append(head, box);
    columns.append(section);
    state.groups.push(group);
  });
  const slider = document.getElementById('share');
  if (slider) {
    const choice = document.getElementById('faded'), output = document.getElementById('percent');
    const shown = () => {
      state.share = slider.value / 100;
      output.textContent = `${slider.value} %`;
      refreshed();
    };
    slider.oninput = shown;
    if (choice) choice.onchange = () => { state.choice = Number(choice.value); refreshed(); };
    document.getElementById('play').onclick = () => {
      const start = performance.now();
      const step = now => {  // to nothing and back within four seconds
        const place = Math.min((now - start) / 4000, 1);
        slider.value = Math.round(100 * Math.abs(1 - 2 * place));
        shown();
        if (place < 1) requestAnimationFrame(step);
      };
      requestAnimationFrame(step);
    };
  }
  drawn();
  if (DATA.arm) state.arm = armDrawing(document.getElementById('arm'));
  let width = innerWidth;
  addEventListener('resize', () => { if (innerWidth !== width) { width = innerWidth; again(); } });
  for (const query of ['(prefers-color-scheme: dark)', 'print']) matchMedia(query).addEventListener('change', again);
}

function again() {
  drawn();
  if (state.arm) state.arm.draw();
}
