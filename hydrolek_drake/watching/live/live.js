// The page of a live watch: it only shows what it is told.
"use strict";
const SPAN = 60; // s that are shown
const SILENT = 3000; // ms without a word from the program after which the page says so
const $ = id => document.getElementById(id);
let told = null, rows = [], heard = 0, charts = [], asked = false;

function element(tag, text, name) { const e = document.createElement(tag); if (text !== undefined) e.textContent = text; if (name) e.className = name; return e; }
function short(value, digits = 3) { return value === null || value === undefined ? "" : String(+value.toPrecision(digits)); }

function build(first) {
  told = first; rows = [];
  document.title = first.title; $("title").textContent = first.title;
  const chosen = $("joint").value;
  $("joint").replaceChildren(...first.joints.map(name => element("option", name)));
  if (first.joints.includes(chosen)) $("joint").value = chosen;
  const list = [
    {name: "position", unit: () => told.units[joint()], lines: [[1, "--measured", 4], [4, "--blue"]], least: 1e-3},
    {name: "innovation / healthy rms", unit: () => "", lines: [[7, "--blue"], [8, "--amber"], [9, "--third"]], names: ["position", "pressure A", "pressure B"], least: 8, zero: true},
    {name: "pressure A", unit: () => told.pressure_unit, lines: [[2, "--measured", 4], [5, "--blue"]], least: 0.2, optional: true},
    {name: "pressure B", unit: () => told.pressure_unit, lines: [[3, "--measured", 4], [6, "--blue"]], least: 0.2, optional: true},
    {name: "command", unit: () => "V", lines: [[0, "--dim"]], least: 1, step: true, low: true},
  ];
  $("charts").replaceChildren();
  charts = list.map(chart => { const canvas = element("canvas", undefined, chart.low ? "low" : "");
    canvas.setAttribute("role", "img"); canvas.setAttribute("aria-label", chart.name); $("charts").append(canvas); return {...chart, canvas}; });
}
function joint() { return Math.max($("joint").selectedIndex, 0); }

function nice(span) { const raw = span / 6, power = 10 ** Math.floor(Math.log10(raw)); return power * [1, 2, 5, 10].find(step => step * power >= raw); }

function own(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }

function draw(chart, breaks) {
  const j = joint(), canvas = chart.canvas;
  let low = Infinity, high = -Infinity, measured = false;
  for (const r of rows) chart.lines.forEach(([at], which) => { const v = r[3][j][at]; if (v === null) return;
    if (which === 0) measured = true; low = Math.min(low, v); high = Math.max(high, v); });
  canvas.hidden = Boolean(chart.optional) && !measured;
  if (canvas.hidden) return;
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (!w) return;
  if (canvas.width !== Math.round(w * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
  const c = canvas.getContext("2d"), left = 52, bottom = 18, top = 18, now = rows.length ? rows[rows.length - 1][1] : 0;
  c.setTransform(ratio, 0, 0, ratio, 0, 0); c.clearRect(0, 0, w, h);
  c.font = "12px system-ui,sans-serif"; c.fillStyle = own("--dim"); c.textAlign = "left"; c.textBaseline = "top";
  const unit = chart.unit(), title = chart.name + (unit ? ` [${unit}]` : ""); c.fillText(title, left, 2);
  const shown = (chart.names || []).filter((_, i) => rows.some(r => r[3][j][chart.lines[i][0]] !== null));
  let begin = left + c.measureText(title).width + 14;
  if (shown.length > 1) chart.names.forEach((name, i) => { if (!shown.includes(name)) return;
    c.fillStyle = own(chart.lines[i][1]); c.fillText(name, begin, 2); begin += c.measureText(name).width + 10; });
  c.fillStyle = own("--dim");
  if (low > high) { c.fillText("nothing yet", left + 8, h / 2); return; }
  if (chart.zero) { const most = Math.max(Math.abs(low), Math.abs(high), chart.least / 2); low = -most; high = most; }
  const middle = (low + high) / 2, half = Math.max(high - low, chart.least) / 2 * 1.08; low = middle - half; high = middle + half;
  const x = t => left + (w - left - 6) * (1 - (now - t) / SPAN), y = v => top + (h - top - bottom) * (high - v) / (high - low);
  c.strokeStyle = own("--soft"); c.lineWidth = 1; c.textAlign = "right"; c.textBaseline = "middle";
  const step = nice(high - low);
  for (let v = Math.ceil(low / step) * step; v <= high; v += step) { c.beginPath(); c.moveTo(left, y(v)); c.lineTo(w - 6, y(v)); c.stroke(); c.fillText(String(+v.toFixed(9)), left - 6, y(v)); }
  c.textBaseline = "bottom";
  for (let back = 0; back <= SPAN; back += 15) { const at = x(now - back); c.beginPath(); c.moveTo(at, top); c.lineTo(at, h - bottom); c.stroke();
    c.textAlign = back ? (back === SPAN ? "left" : "center") : "right"; c.fillText(back ? `-${back} s` : "now", back ? at : w - 6, h); }
  c.save(); c.beginPath(); c.rect(left, top, w - left - 6, h - top - bottom); c.clip();
  c.fillStyle = own("--doubt");
  rows.forEach((r, i) => { if (!r[2] && i) { const from = x(rows[i - 1][1]), to = x(r[1]); if (to > from && to - from < 20) c.fillRect(from, top, to - from + .5, h); } });
  c.strokeStyle = own("--red"); c.lineWidth = 2;
  for (const at of breaks) { c.beginPath(); c.moveTo(x(at), top); c.lineTo(x(at), h - bottom); c.stroke(); }
  c.lineJoin = "round";
  for (const [at, colour, wide] of chart.lines) { c.strokeStyle = own(colour); c.lineWidth = wide || 1.5; c.beginPath(); let open = false, last = null;
    for (const r of rows) { const v = r[3][j][at]; if (v === null || (last !== null && Math.abs(r[1] - last) > 1)) open = false;
      last = r[1]; if (v === null) continue;
      if (open && chart.step) c.lineTo(x(r[1]), y(open)); if (open !== false) c.lineTo(x(r[1]), y(v)); else c.moveTo(x(r[1]), y(v)); open = chart.step ? v : true; }
    c.stroke(); }
  c.restore();
}

const HEADS = ["effect", "what", "size alone (95 %)", "beside the first", "gain", "threshold"];
const COUNTS = [["taken", "samples"], ["lost", "lost"], ["late", "late, put in place"], ["doubled", "doubled"], ["too_late", "too late"], ["astray", "astray in time"], ["no_time", "without time"], ["bad", "bad lines"], ["dropped", "dropped here"]];

function show(status) {
  const alarm = status.alarm.length > 0, head = $("head");
  head.className = alarm ? "alarm" : status.settled ? "ok" : "unsure";
  $("say").textContent = alarm ? status.alarm.join(" ") : status.settled ? "No alarm: the machine moves as its healthy model does."
    : rows.length ? "No alarm; the observer settles, and nothing is judged until it has." : "Nothing has come yet.";
  const link = status.link;
  $("lamp").textContent = link.state; $("lamp").className = `lamp ${link.state}`; $("link_name").textContent = link.name; $("link_text").textContent = link.text;
  $("counts").replaceChildren(...COUNTS.filter(([key]) => link[key] || ["taken", "lost", "late", "doubled"].includes(key)).map(([key, name]) => {
    const box = element("div"); box.append(element("dt", name), element("dd", link[key].toLocaleString("en"))); return box; }));
  $("innovations").replaceChildren(...status.innovations.map((each, i) => {
    const tr = element("tr", undefined, i === joint() ? "now" : ""), td = element("td", undefined, "text"), bar = element("span", undefined, "bar"), fill = element("i", undefined, each.share >= 1 ? "beyond" : "");
    fill.style.width = `${Math.min(100 * (each.share || 0), 100)}%`; bar.append(fill); td.append(bar, each.share > 1 ? " over 100 %" : ` ${Math.round(100 * (each.share || 0))} %`);
    tr.dataset.joint = i; tr.append(element("td", each.joint, "text"), td, element("td", short(each.mean, 2)), element("td", short(each.rms, 2))); return tr; }));
  $("events").replaceChildren(...(status.events.length ? [...status.events].reverse().map(e => { const li = element("li", undefined, e.kind === "alarm" ? "alarm" : "");
    li.append(element("time", new Date(1000 * e.now).toLocaleTimeString("en-GB")), e.text); return li; }) : [element("li", "none so far")]));
  const w = status.windows;
  $("window").textContent = !w.asks ? "The joints of this rig move together: which effect changed is told by hydrolek watch over recordings of them, not here."
    : [w.headline, w.time ? `Last window: ${w.time}.` : "", w.busy ? "A window is being asked." : `Next window: ${w.gathered} of ${w.length} s gathered.`,
    `${w.count} asked${w.passed_over ? `, ${w.passed_over} passed over` : ""}.`].filter(Boolean).join(" ");
  $("effects").replaceChildren(...w.effects.map(e => { const tr = element("tr", undefined, e.beyond ? "beyond" : "");
    tr.append(element("td", e.joint ? `${e.effect}, ${e.joint}` : e.effect, "text"), element("td", e.title, "text what"), element("td", e.size), element("td", e.beside), element("td", short(e.gain)), element("td", short(e.threshold)));
    [...tr.cells].forEach((td, i) => { td.dataset.head = HEADS[i]; }); return tr; }));
}

function redraw(status) {
  const breaks = status.events.filter(e => !["alarm", "refused", "link"].includes(e.kind) && e.time !== null).map(e => e.time);
  charts.forEach(chart => draw(chart, breaks));
}
let status = null;
function take(message) {
  heard = performance.now();
  if (message.title) build(message);
  for (const r of message.rows) {
    if (rows.length && r[1] < rows[rows.length - 1][1]) rows = []; // the clock went back
    if (!rows.length || r[0] > rows[rows.length - 1][0]) rows.push(r); }
  const now = rows.length ? rows[rows.length - 1][1] : 0;
  rows = rows.filter(r => now - r[1] <= SPAN);
  status = message.status; show(status);
  if (!asked) { asked = true; requestAnimationFrame(() => { asked = false; redraw(status); }); }
}
function connect() {
  const socket = new WebSocket(`ws://${location.host}/socket`);
  socket.onmessage = event => take(JSON.parse(event.data));
  socket.onclose = () => { $("head").className = "unsure"; $("say").textContent = "The program has ended, or cannot be reached; trying again."; setTimeout(connect, 1000); };
}
setInterval(() => { if (heard && performance.now() - heard > SILENT) { $("head").className = "unsure"; $("say").textContent = "Nothing has been heard from the program for a while."; } }, 1000);
$("joint").addEventListener("change", () => status && (show(status), redraw(status)));
$("innovations").addEventListener("click", event => { const tr = event.target.closest("tr[data-joint]"); if (tr && status) { $("joint").selectedIndex = +tr.dataset.joint; show(status); redraw(status); } });
window.addEventListener("resize", () => status && redraw(status));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => status && redraw(status));
connect();
