// Strip charts of the last 30 s: angles, chamber pressures and voltages of both arms, drawn on canvas.
"use strict";
const CHART_SPAN = 30; // s
const JOINT_COLOURS = ["#1769aa", "#c1121f", "#1b7f3b", "#b36b00", "#6a3d9a", "#00818a", "#5c6870"];
const CHARTS = [
  {title: "angle / deg (set point dashed)", lines: ["angles_deg", "desired_deg"], least: 10},
  {title: "pressure / MPa (A solid, B dashed, supply grey)", lines: ["pressure_a_MPa", "pressure_b_MPa"], least: 5, from: 0},
  {title: "voltage / V", lines: ["voltage_V"], least: 2},
];

function makeCharts(box, keys, pace) {
  let samples = [];
  const canvases = [];
  for (const side of ["Right arm", "Left arm"]) { const head = document.createElement("h3"); head.textContent = side; box.append(head); }
  for (const chart of CHARTS) for (const arm of [0, 1]) {
    const canvas = document.createElement("canvas");
    canvas.setAttribute("role", "img"); canvas.setAttribute("aria-label", `${arm ? "left" : "right"} arm, ${chart.title}`);
    box.append(canvas); canvases.push({canvas, chart, arm});
  }
  const shown = JOINT_COLOURS.map((colour, i) => {
    const label = document.createElement("label"); label.className = "key";
    label.innerHTML = `<input type="checkbox" checked><b style="background:${colour}"></b>joint ${i + 1}${i === 6 ? " (jaw)" : ""}`;
    keys.append(label);
    return label.querySelector("input");
  });
  function nice(span) { // a step of 1, 2 or 5 that divides the span into at most five parts
    const raw = span / 5, power = 10 ** Math.floor(Math.log10(raw));
    return power * [1, 2, 5, 10].find(step => step * power >= raw);
  }
  function draw({canvas, chart, arm}) {
    const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
    if (!w) return;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
    const c = canvas.getContext("2d"), left = 44, bottom = 18, top = 16, now = samples[samples.length - 1].t;
    c.setTransform(ratio, 0, 0, ratio, 0, 0); c.clearRect(0, 0, w, h);
    const joints = shown.flatMap((input, i) => input.checked ? [i] : []);
    let low = Infinity, high = -Infinity;
    for (const s of samples) for (const name of chart.lines) for (const i of joints) {
      const value = s[name] && s[name][i + 7 * arm]; if (value === null || value === undefined) continue;
      low = Math.min(low, value); high = Math.max(high, value); }
    c.font = "12px system-ui,sans-serif"; c.fillStyle = "#5c6870"; c.textAlign = "left"; c.textBaseline = "top";
    c.fillText(chart.title, left, 0);
    if (low > high) { c.fillText("no such signal from these arms, or no joint chosen", left + 8, h / 2); return; }
    if (chart.from !== undefined) low = Math.min(low, chart.from);
    const middle = (low + high) / 2, half = Math.max(high - low, chart.least) / 2 * 1.08;
    if (chart.from === undefined) { low = middle - half; high = middle + half; } else high = Math.max(high, low + chart.least) * 1.05;
    const x = t => left + (w - left - 6) * (1 - (now - t) / CHART_SPAN), y = v => top + (h - top - bottom) * (high - v) / (high - low);
    c.strokeStyle = "#e1e6e9"; c.lineWidth = 1; c.textAlign = "right"; c.textBaseline = "middle";
    const step = nice(high - low);
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) {
      c.beginPath(); c.moveTo(left, y(v)); c.lineTo(w - 6, y(v)); c.stroke(); c.fillText(String(+v.toFixed(6)), left - 6, y(v)); }
    c.textBaseline = "bottom"; c.textAlign = "center";
    for (let back = 0; back <= CHART_SPAN; back += 10) {
      const at = x(now - back); c.beginPath(); c.moveTo(at, top); c.lineTo(at, h - bottom); c.stroke();
      c.textAlign = back ? "center" : "right"; c.fillText(back ? `-${back} s` : "now", back ? at : w - 6, h); }
    c.save(); c.beginPath(); c.rect(left, top, w - left - 6, h - top - bottom); c.clip();
    const line = (pick, colour, dashes) => {
      c.strokeStyle = colour; c.setLineDash(dashes); c.beginPath(); let open = false;
      for (const s of samples) { const value = pick(s);
        if (value === null || value === undefined) { open = false; continue; }
        if (open) c.lineTo(x(s.t), y(value)); else c.moveTo(x(s.t), y(value)); open = true; }
      c.stroke(); };
    c.lineWidth = 1.6;
    if (chart.lines[0] === "pressure_a_MPa") line(s => s.supply_MPa, "#b8c0c4", []);
    chart.lines.forEach((name, which) => { for (const i of joints) line(s => s[name] && s[name][i + 7 * arm], JOINT_COLOURS[i], which ? [4, 3] : []); });
    c.restore(); c.setLineDash([]);
  }
  return {
    add(state) {
      const t = performance.now() / 1000;
      samples.push({t, angles_deg: state.angles_deg, desired_deg: state.desired_deg, ...(state.signals || {})});
      samples = samples.filter(s => t - s.t <= CHART_SPAN);
      const slow = state.signals && state.signals.pace < 0.95;
      pace.textContent = slow ? `(the plant runs at ${state.signals.pace} of real time: this computer is too slow)` : "";
      canvases.forEach(draw);
    },
  };
}
