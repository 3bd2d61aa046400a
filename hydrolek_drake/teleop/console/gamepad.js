// Gamepads as joysticks with a dead-man's switch: L1 held moves the left arm, R1 the right one.
// What was held before this page could see it let go, or while it could not, counts for nothing: a gamepad is used from the
// moment on at which both of its switches were seen open, by a page that has the focus.
"use strict";
const STICK_PLAY = 0.15; // of a gamepad's sticks around their middle
const L1 = 4, R1 = 5, AXES = 4, BUTTONS = 16; // of the layout "standard" (W3C, Gamepad, remapping)

function makeGamepad(line) { // line: element that says what a gamepad does now
  let open = new Set(); // gamepads whose switches were seen open
  const name = pad => `${pad.index} ${pad.id}`;
  const usable = pad => pad.mapping === "standard" && pad.axes.length >= AXES && pad.buttons.length >= BUTTONS && [...pad.axes].every(Number.isFinite);
  const down = (pad, i) => pad.buttons[i].pressed === true;
  const held = pad => down(pad, L1) || down(pad, R1);
  function wish(pad) { // 14 deflections in shares
    const stick = i => Math.abs(pad.axes[i]) > STICK_PLAY ? Math.max(-1, Math.min(1, pad.axes[i])) : 0;
    const both = (up, low) => down(pad, up) - down(pad, low), deflection = new Array(14).fill(0), at = down(pad, L1) ? 7 : 0;
    [stick(0), -stick(1), -stick(3), stick(2), both(12, 13), both(15, 14), both(1, 0)].forEach((value, i) => { deflection[at + i] = value; });
    return deflection;
  }
  return {
    ignore() { open.clear(); }, // until it is let go
    wish() { // while one switch is held: deflections of 14 joints in shares; else null
      const here = navigator.getGamepads ? [...navigator.getGamepads()].filter(pad => pad && pad.connected !== false) : [];
      const pads = here.filter(usable), watched = document.hasFocus() && !document.hidden;
      open = new Set(watched ? pads.filter(pad => open.has(name(pad)) || !held(pad)).map(name) : []);
      const ready = pads.filter(pad => open.has(name(pad))), holding = pads.filter(held);
      line.textContent = !here.length ? "" : !pads.length ? "Gamepad: its layout is not the standard one; not used."
        : ready.length < pads.length ? "Gamepad: let go of L1 and R1 first."
        : "Gamepad: hold L1 for the left arm, R1 for the right; sticks joints 1 to 4, cross 5 and 6, A and B the jaw.";
      const [pad] = holding;
      return holding.length === 1 && ready.includes(pad) && !(down(pad, L1) && down(pad, R1)) ? wish(pad) : null;
    },
  };
}
