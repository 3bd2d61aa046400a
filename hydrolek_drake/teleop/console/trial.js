// Task timer and the six ratings of NASA-TLX.
"use strict";
const SCALES = {
  mental: ["Mental demand", "very low", "very high"], physical: ["Physical demand", "very low", "very high"],
  temporal: ["Temporal demand", "very low", "very high"], performance: ["Performance", "perfect", "failure"],
  effort: ["Effort", "very low", "very high"], frustration: ["Frustration", "very low", "very high"],
};

function makeTrial(send) {
  const $ = id => document.getElementById(id), inputs = {};
  for (const [name, [title, low, high]] of Object.entries(SCALES)) {
    const label = document.createElement("label");
    label.innerHTML = `${title}<input type="range" min="0" max="100" step="5" value="50"><output>50</output><small><span>${low}</span><span>${high}</span></small>`;
    inputs[name] = label.querySelector("input");
    inputs[name].oninput = () => { label.querySelector("output").textContent = inputs[name].value; };
    $("ratings").append(label);
  }
  for (const action of ["start", "stop", "reset"]) $(`timer_${action}`).onclick = () => send({do: "timer", action});
  $("save").onclick = () => send({do: "ratings", operator: $("operator").value, control: $("control").value, note: $("remark").value,
    ...Object.fromEntries(Object.entries(inputs).map(([name, input]) => [name, Number(input.value)]))});
  return {
    draw(state, mine) {
      $("clock").textContent = `${(state.seconds || 0).toFixed(1)} s`;
      $("timer_start").disabled = !mine || state.running; $("timer_stop").disabled = !mine || !state.running; $("timer_reset").disabled = !mine || state.seconds === null;
      $("save").disabled = !mine || !state.file || state.running || state.seconds === null;
      $("saved").textContent = !state.file ? "Not kept: start with --out FOLDER to save trials." : `${state.saved} saved in ${state.file.split("/").slice(-2).join("/")}`;
      $("saved").title = state.file || "";
    },
  };
}
