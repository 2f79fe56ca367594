// The head of the page: source, clock, experiment, palette.

import { put, segments } from "../dom.js";
import { clock, DASH, known, plain } from "../figures.js";

const SOURCES = { simulate: "simulator", replay: "replay", nmea: "NMEA 0183", signalk: "Signal K" };
const PALETTES = ["day", "dusk", "night"];
const SHELF = "shipid-bridge-palette";

/** Return a function that writes source, time and experiment. */
export function createMasthead() {
  const [source, time, experiment] = ["source", "clock", "experiment"].map((id) => document.getElementById(id));
  return (state) => {
    const now = state.time ?? {};
    const name = state.ship?.name ? `${state.ship.name} · ` : "";
    const pace = known(now.clock_factor) ? ` ×${now.clock_factor}` : "";
    const standing = now.state && now.state !== "running" ? ` · ${now.state}` : "";
    put(source, `${name}${SOURCES[now.source] ?? now.source ?? DASH}${pace}${standing}`);
    put(time, now.utc ? `UTC ${now.utc.slice(11, 19)}` : `t ${clock(now.t)}`);
    const test = state.experiment;
    experiment.hidden = !test;
    if (test) put(experiment, line(test));
  };
}

function line({ scenario, condition, leg, of, rms, done }) {
  const parts = [`Track ${scenario}`, `condition ${condition}`, done ? "finished" : `leg ${leg + 1} of ${of}`];
  if (known(rms)) parts.push(`RMS ${plain(rms, 0)} m`);
  return parts.join(" · ");
}

/** Let the palette be chosen, remember it, and call a function after every change. */
export function createPalettes(changed) {
  const holder = document.getElementById("palettes");
  const text = (name) => name[0].toUpperCase() + name.slice(1);
  const { show } = segments(holder, PALETTES.map((value) => ({ value, text: text(value) })), set);

  function set(name) {
    document.documentElement.dataset.palette = name;
    show(name);
    try {
      localStorage.setItem(SHELF, name);
    } catch { /* Where nothing may be stored, the palette holds until the page is closed. */ }
    changed();
  }

  let before = null;
  try {
    before = localStorage.getItem(SHELF);
  } catch { /* as above */ }
  set(PALETTES.includes(before) ? before : matchMedia("(prefers-color-scheme: dark)").matches ? "dusk" : "day");
}
