'use strict';
// The arm at the moment under the cursor: boxes and cylinders, the farthest painted first; the model's link as an outline.
function armDrawing(canvas) {
  const arm = DATA.arm, view = {yaw: 0.6, pitch: 0.25, zoom: 1};
  arm.recordings.forEach(r => Object.values(r).forEach(a => { a.x = floats(a.x); a.y = floats(a.y); }));

  const times = (a, b) => {  // of homogeneous transforms without their last row
    const out = [];
    for (let i = 0; i < 3; i++) for (let j = 0; j < 4; j++)
      out.push(a[4 * i] * b[j] + a[4 * i + 1] * b[4 + j] + a[4 * i + 2] * b[8 + j] + (j === 3 ? a[4 * i + 3] : 0));
    return out;
  };
  const moved = (m, p) => [0, 4, 8].map(i => m[i] * p[0] + m[i + 1] * p[1] + m[i + 2] * p[2] + m[i + 3]);
  const turn = ([x, y, z], angle) => {
    const c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
    return [t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0, t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0,
      t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0];
  };

  function faces(shape) {
    if (shape.kind === 'box') {
      const [a, b, c] = shape.size.map(v => v / 2);
      const p = [[-a, -b, -c], [a, -b, -c], [a, b, -c], [-a, b, -c], [-a, -b, c], [a, -b, c], [a, b, c], [-a, b, c]];
      return [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [2, 3, 7, 6], [1, 2, 6, 5], [3, 0, 4, 7]].map(f => f.map(i => p[i]));
    }
    const [radius, length] = shape.size, n = 14, ring = z => Array.from({length: n}, (_, i) =>
      [radius * Math.cos(2 * Math.PI * i / n), radius * Math.sin(2 * Math.PI * i / n), z]);
    const low = ring(-length / 2), high = ring(length / 2);
    return [high, [...low].reverse(), ...low.map((p, i) => [p, low[(i + 1) % n], high[(i + 1) % n], high[i]])];
  }
  for (const link of arm.links) for (const shape of link.shapes)
    shape.faces = faces(shape).map(f => f.map(p => moved(shape.pose, p)));

  const nearest = (series, time) => {
    let low = 0, high = series.x.length - 1;
    while (high - low > 1) { const middle = (low + high) >> 1; if (series.x[middle] > time) high = middle; else low = middle; }
    for (let i = low; i >= 0; i--) if (series.y[i] != null) return series.y[i];
    return null;
  };

  function poses(angles) {
    const out = [];
    for (const link of arm.links) {
      let pose = link.parent < 0 ? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0] : times(out[link.parent], link.origin);
      if (link.axis) pose = times(pose, turn(link.axis, angles[link.joint] ?? 0));
      out.push(pose);
    }
    return out;
  }

  function modelAngle(number, time) {
    const chart = DATA.recordings[number].charts[0];
    const degrees = nearest({x: chart.x, y: modelled(chart)}, time);
    return degrees == null ? null : degrees * Math.PI / 180;
  }

  function draw() {
    const number = state.last ?? 0, time = state.time[number], ratio = devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight, ctx = canvas.getContext('2d');
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    ctx.scale(ratio, ratio);
    const measured = {...arm.posture};
    for (const [joint, series] of Object.entries(arm.recordings[number])) measured[joint] = nearest(series, time) ?? 0;
    const model = {...measured, [arm.joint]: modelAngle(number, time) ?? measured[arm.joint]};
    const [cy, sy, cp, sp] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
    const seen = p => {  // across, up, towards the eye; the world's UP axis stays upright on the screen
      const [forward, side, up] = [p[0], p[1], p[2]];
      const across = -forward * sy + side * cy, depth = forward * cy + side * sy;
      return [across, up * cp - depth * sp, depth * cp + up * sp];
    };
    const polygons = [];
    poses(measured).forEach((pose, i) => arm.links[i].shapes.forEach(shape => shape.faces.forEach(face => {
      const points = face.map(p => seen(moved(pose, p)));
      const [a, b, c] = points, u = b.map((v, k) => v - a[k]), w = c.map((v, k) => v - b[k]);
      const normal = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
      if (normal[2] <= 0) return;
      const light = (0.45 * normal[1] + 0.75 * normal[2] + 0.3 * normal[0]) / Math.hypot(...normal);
      polygons.push({points, depth: points.reduce((s, p) => s + p[2], 0) / points.length,
        fill: shape.colour.map(v => Math.round(v * (0.5 + 0.5 * Math.max(light, 0))))});
    })));
    if (!view.box) view.box = extent(seen, number);
    const box = view.box, scale = view.zoom * 0.9 * Math.min(width / (box[1] - box[0]), height / (box[3] - box[2]));
    const place = p => [width / 2 + scale * (p[0] - (box[0] + box[1]) / 2), height / 2 - scale * (p[1] - (box[2] + box[3]) / 2)];
    const path = points => { ctx.beginPath(); points.forEach((p, i) => ctx[i ? 'lineTo' : 'moveTo'](...place(p))); ctx.closePath(); };
    polygons.sort((a, b) => a.depth - b.depth);
    for (const {points, fill} of polygons) {
      path(points);
      ctx.fillStyle = ctx.strokeStyle = `rgb(${fill})`;
      ctx.lineWidth = .6;
      ctx.fill();
      ctx.stroke();
    }
    ctx.strokeStyle = colour('found');
    ctx.lineWidth = 1;
    const first = arm.links.findIndex(link => link.joint === arm.joint), beyond = new Set([first]);
    arm.links.forEach((link, i) => { if (beyond.has(link.parent)) beyond.add(i); });
    poses(model).forEach((pose, i) => beyond.has(i) && arm.links[i].shapes.forEach(shape => shape.faces.slice(0, 2).forEach(face => {
      path(face.map(p => seen(moved(pose, p))));
      ctx.stroke();
    })));
    const degrees = v => (v * 180 / Math.PI).toFixed(2);
    document.getElementById('arm-says').textContent = `${DATA.recordings[number].title.split(':')[0]} at ${time.toFixed(2)} s: ` +
      `measured ${degrees(measured[arm.joint])} deg, model ${degrees(model[arm.joint])} deg`;
  }

  function extent(seen, number) {  // of all the arm's postures in this recording, so that the picture stands still
    const ends = [Infinity, -Infinity, Infinity, -Infinity];
    const {begin, end} = DATA.recordings[number];
    for (let k = 0; k <= 12; k++) {
      const angles = {...arm.posture};
      for (const [joint, series] of Object.entries(arm.recordings[number]))
        angles[joint] = nearest(series, begin + k * (end - begin) / 12) ?? 0;
      poses(angles).forEach((pose, i) => arm.links[i].shapes.forEach(shape => shape.faces.forEach(face => face.forEach(p => {
        const [x, y] = seen(moved(pose, p));
        ends[0] = Math.min(ends[0], x); ends[1] = Math.max(ends[1], x);
        ends[2] = Math.min(ends[2], y); ends[3] = Math.max(ends[3], y);
      }))));
    }
    return ends;
  }

  let held = null;
  canvas.onpointerdown = e => { held = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); };
  canvas.onpointerup = canvas.onpointercancel = () => { held = null; };
  canvas.onpointermove = e => {
    if (!held) return;
    view.yaw -= (e.clientX - held[0]) / 150;
    view.pitch = Math.min(Math.max(view.pitch + (e.clientY - held[1]) / 150, -1.5), 1.5);
    view.box = null;
    held = [e.clientX, e.clientY];
    draw();
  };
  draw();
  return {draw};
}
