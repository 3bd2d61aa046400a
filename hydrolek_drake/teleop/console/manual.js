// Joints by hand: buttons and gamepad as joysticks, and sliders. Motion lasts while something is held; every wish is
// sent again each 100 ms, and the machine stops by itself when the messages cease.
"use strict";
const HAND_PERIOD = 100; // ms

function makeManual(send) {
  const $ = id => document.getElementById(id), JOINTS = 14;
  const held = new Array(JOINTS).fill(0), sliders = [], readings = [], touched = new Array(JOINTS).fill(false), buttons = [];
  let allowed = false, going = false, sliding = false, state = null;
  const gamepad = makeGamepad($("gamepad"));
  const release = () => { held.fill(0); gamepad.ignore(); sliding = false; document.querySelectorAll("#hand button, #hold").forEach(b => b.classList.remove("held")); tell(); };
  function holds(button, begin, end) { // pointer, or Space and Enter on the focused button
    const start = event => { event.preventDefault(); if (!allowed) return; begin(); button.classList.add("held"); tell(); };
    const stop = () => { end(); button.classList.remove("held"); tell(); };
    button.addEventListener("pointerdown", event => { if (event.button === 0) { button.focus(); start(event); } });
    for (const what of ["pointerup", "pointerleave", "pointercancel", "blur"]) button.addEventListener(what, stop);
    button.addEventListener("keydown", event => { if ([" ", "Enter"].includes(event.key)) { event.stopPropagation(); if (event.repeat) event.preventDefault(); else start(event); } });
    button.addEventListener("keyup", event => { if ([" ", "Enter"].includes(event.key)) { event.preventDefault(); stop(); } });
    button.addEventListener("contextmenu", event => event.preventDefault());
  }
  for (let row = 0; row < 7; row++) for (const arm of [0, 1]) {
    const j = row + 7 * arm, name = `${arm ? "left" : "right"} ${row + 1}`, box = document.createElement("div");
    box.className = "joint";
    box.innerHTML = `<span>${name}</span><button aria-label="${name} down">−</button><button aria-label="${name} up">+</button>` +
      `<input type="range" aria-label="${name}, wanted angle in degrees" step="0.5"><span class="now"></span>`;
    const [down, up] = box.querySelectorAll("button");
    holds(down, () => { held[j] = -1; }, () => { held[j] = 0; });
    holds(up, () => { held[j] = 1; }, () => { held[j] = 0; });
    buttons.push(down, up);
    sliders[j] = box.querySelector("input"); readings[j] = box.querySelector(".now");
    sliders[j].oninput = () => { touched[j] = true; };
    $("hand").append(box);
  }
  holds($("hold"), () => { sliding = true; }, () => { sliding = false; });
  $("match").onclick = () => touched.fill(false);
  window.addEventListener("blur", release);
  document.addEventListener("visibilitychange", () => { if (document.hidden) release(); });
  document.addEventListener("keydown", event => { if (event.key === "Escape") release(); }, true);

  function want(message) { // a new wish first says that the last one has ended: after a stop only that counts
    if (!going) send({do: "let_go"});
    going = true; send(message);
  }
  function tell() {
    const pad = gamepad.wish(), full = Number($("deflection").value);
    const wish = held.map((value, j) => full * (value || (pad ? pad[j] : 0)));
    if (allowed && sliding) want({do: "sliders_to", angles_deg: sliders.map(s => Number(s.value))});
    else if (allowed && (wish.some(Boolean) || going && pad)) want({do: "joystick", deflection: wish}); // a stick in its middle is not yet let go
    else if (going) { going = false; send({do: "let_go"}); }
  }
  setInterval(tell, HAND_PERIOD);
  return {
    release,
    draw(next, mayMove) {
      state = next;
      if (allowed && !mayMove) { allowed = false; release(); }
      allowed = mayMove;
      $("deflection").nextElementSibling.textContent = `${$("deflection").value} %`;
      for (const button of [...buttons, $("hold"), $("match")]) button.disabled = !mayMove;
      $("by_hand").textContent = state.manual || "let go"; $("by_hand").className = "lamp" + (state.manual ? " open" : "");
      sliders.forEach((slider, j) => {
        const [low, high] = [state.limits_deg[0][j], state.limits_deg[1][j]];
        if (slider.min !== String(low)) { slider.min = low; slider.max = high; }
        if (!touched[j]) slider.value = state.angles_deg[j];
        slider.disabled = !mayMove;
        readings[j].textContent = `${degrees(Number(slider.value))} | at ${degrees(state.angles_deg[j])}`;
      });
    },
  };
}
