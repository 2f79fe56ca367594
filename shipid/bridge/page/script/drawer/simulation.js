// The clock of what is simulated or replayed; the simulator's weather and the ship's own parameters, changed while she sails, so that the adaptation can be watched.

import { el, mark, put, segments } from "../dom.js";
import { coefficient, DEG, direction, known, KNOT, plain } from "../figures.js";

/** How long in ms a slider that was moved goes before the server's value. */
const PATIENCE = 1500;

const WEATHER = [
  { key: "current_speed", label: "Current", low: 0, high: 6, step: 0.1, unit: KNOT, write: (n) => `${plain(n, 1)} kn` },
  { key: "current_direction_to", label: "Current flows to", low: 0, high: 359, step: 1, unit: DEG, write: (n) => direction(n * DEG) },
  { key: "wind_speed", label: "Wind", low: 0, high: 25, step: 0.5, unit: 1, write: (n) => `${plain(n, 1)} m/s` },
  { key: "wind_direction_from", label: "Wind comes from", low: 0, high: 359, step: 1, unit: DEG, write: (n) => direction(n * DEG) },
];

function createSlider({ label, low, high, step, write, give }) {
  const value = el("output");
  const input = el("input", { type: "range", min: low, max: high, step, "aria-label": label });
  const box = el("label", { class: "slider" }, el("span", {}, label), value, input);
  let moved = -Infinity;
  input.addEventListener("input", () => {
    moved = performance.now();
    put(value, write(Number(input.value)));
    mark(input, "aria-valuetext", write(Number(input.value)));
    give(Number(input.value));
  });
  return {
    box,
    show(number) {
      box.hidden = !known(number);
      if (!known(number) || performance.now() - moved < PATIENCE) return;
      input.value = String(number);
      put(value, write(number));
      mark(input, "aria-valuetext", write(number));
    },
  };
}

/** Return the part of the drawer that steers the simulator. */
export function createSimulation(model, send) {
  const order = (part) => send({ command: "simulation", ...part });
  const paces = el("div", { class: "segments", role: "radiogroup", "aria-label": "Clock factor" });
  const pause = el("button", { type: "button", "aria-pressed": "false" }, "Pause");
  pause.addEventListener("click", () => order({ paused: !model.state.simulation?.paused }));
  const weather = WEATHER.map((item) => ({ ...item, ...createSlider({ ...item, give: (n) => order({ [item.key]: n * item.unit }) }) }));
  const list = el("div");
  const title = el("h2", {}, "Simulation");
  const section = el("section", {}, title, el("div", { class: "pace" }, paces, pause), ...weather.map(({ box }) => box), list);
  const sliders = new Map();
  const offered = new Set();
  let pace = null;

  function sliderOf(item) {
    if (!sliders.has(item.name)) {
      const [low, high] = [item.low ?? Math.min(0, 2 * item.value), item.high ?? Math.max(0, 2 * item.value)];
      const unit = item.unit && item.unit !== "1" ? ` ${item.unit}` : "";
      const slider = createSlider({
        label: `Ship's ${item.label}`, low, high, step: "any", write: (n) => `${coefficient(n)}${unit}`,
        give: (value) => order({ coefficient: item.name, value }),
      });
      list.append(slider.box);
      sliders.set(item.name, slider);
    }
    return sliders.get(item.name);
  }

  return {
    section,
    show({ simulation, time }) {
      section.hidden = !simulation;
      if (!simulation) return;
      // A record that is played has a clock to be set, and nothing else.
      put(title, time?.source === "replay" ? "Clock" : "Simulation");
      // The factor the bridge was opened with stays a choice after another was chosen.
      for (const factor of [...(simulation.clock_factors ?? []), simulation.clock_factor]) if (known(factor)) offered.add(factor);
      const factors = [...offered].sort((a, b) => a - b);
      if (pace?.signature !== factors.join()) {
        pace = { signature: factors.join(), ...segments(paces, factors.map((value) => ({ value, text: `×${value}` })), (value) => order({ clock_factor: value })) };
      }
      pace.show(simulation.clock_factor);
      mark(pause, "aria-pressed", simulation.paused ? "true" : "false");
      put(pause, simulation.paused ? "Paused" : "Pause");
      for (const item of weather) item.show(known(simulation[item.key]) ? simulation[item.key] / item.unit : null);
      for (const item of simulation.coefficients ?? []) sliderOf(item).show(item.value);
    },
  };
}
