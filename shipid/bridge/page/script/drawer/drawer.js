// The drawer: notes of the route and the chart, adaptation, simulation, sensors, keys. It stands beside the plan view and hides nothing of the console.

import { el, mark } from "../dom.js";
import { KEYS } from "../console/keys.js";
import { createAdaptation } from "./adaptation.js";
import { createNotes } from "./notes.js";
import { createSensors } from "./sensors.js";
import { createSimulation } from "./simulation.js";

function createKeyList() {
  const box = el("input", { type: "checkbox", id: "letters" });
  box.checked = true;
  const rows = KEYS.map(([keys, text]) => el("tr", {}, el("td", {}, ...keys.flatMap((key, i) => [i ? " " : "", el("kbd", {}, key)])), el("td", {}, text)));
  const section = el("section", {}, el("h2", {}, "Keys"), el("label", { class: "check" }, box, "Letters and signs are keys"), el("table", {}, el("tbody", {}, ...rows)));
  return { section, letters: () => box.checked };
}

/** Return the drawer: a function that shows it, and whether letters are keys. */
export function createDrawer(model, send, plan) {
  const drawer = document.getElementById("drawer");
  const key = document.getElementById("drawer-key");
  const main = document.getElementById("bridge");
  const [notes, adaptation, simulation, sensors, keys] = [createNotes(), createAdaptation(), createSimulation(model, send), createSensors(model), createKeyList()];
  drawer.append(adaptation.section, simulation.section, notes.section, sensors.section, keys.section);
  key.addEventListener("click", () => {
    drawer.hidden = !drawer.hidden;
    mark(key, "aria-expanded", drawer.hidden ? "false" : "true");
    main.classList.toggle("open", !drawer.hidden);
    show(model.state, new Set(Object.keys(model.state)));
    plan.draw();
  });

  function show(state, changed) {
    adaptation.gather(state, changed);
    if (drawer.hidden) return;
    notes.show(state);
    adaptation.show(state);
    simulation.show(state);
    sensors.show(state);
  }
  return { show, letters: keys.letters };
}
