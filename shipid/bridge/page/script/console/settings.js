// The trial settings: what the navigator turned a moment ago, until the server has said what it made of it.

import { DEG, direction, halfTurn, known, perMinute, rudder } from "../figures.js";

/** How long in ms a setting of the page goes before the server's. */
const PATIENCE = 1500;

/** What each mode turns: its key in the settings, steps in degrees (a minute), how it is written and read. */
export const MODES = {
  heading: {
    name: "Heading", key: "heading", label: "Trial heading", unit: "°", step: DEG, big: 5 * DEG, write: (v) => direction(v).slice(0, -1),
    read: (n) => n * DEG, hint: "A heading is a number from 0 to 360.", fits: (n) => n >= 0 && n <= 360,
  },
  rudder: {
    name: "Rudder", key: "rudder", label: "Trial rudder", unit: "°", step: DEG, big: 5 * DEG, write: (v) => rudder(v).replace("°", ""),
    read: (n) => n * DEG, hint: "A rudder angle is a number of degrees, with P or − to port.", fits: () => true,
  },
  rate: {
    name: "Rate", key: "rate", label: "Trial rate of turn", unit: "°/min", step: DEG / 60, big: 5 * DEG / 60, write: perMinute,
    read: (n) => n * DEG / 60, hint: "A rate of turn is a number of degrees a minute, with P or − to port.", fits: () => true,
  },
  track: { name: "Track", key: null, label: "Track pilot" },
};

/** Whether a mode turns to the trial heading: a rate of turn does, and ends there. */
export const toHeading = (mode) => mode === "heading" || mode === "rate";

/** Say a set of settings in words: "075.0°, limit 10°". */
export function inWords(set) {
  if (!set) return "nothing yet";
  const limit = known(set.rudder_limit) ? `, limit ${(set.rudder_limit / DEG).toFixed(0)}°` : "";
  if (set.mode === "rudder") return `rudder ${rudder(set.rudder)}`;
  if (set.mode === "rate") return `rate ${perMinute(set.rate)}°/min to ${direction(set.heading)}${limit}`;
  // The track pilot gives more rudder than planned where a turn gets too wide: it is no limit.
  if (set.mode === "track") return `track pilot, turns planned with ${(set.rudder_limit / DEG).toFixed(0)}°`;
  return `heading ${direction(set.heading)}${limit}`;
}

const same = (a, b) => a === b || (known(a) && known(b) && Math.abs(a - b) < 1e-6);

/** Return the trial settings as the page shows them, and the ways to change them. */
export function createSettings(model, send) {
  const waiting = new Map();
  const watchers = [];

  const server = () => model.state.settings?.trial ?? {};
  const limits = (key) => model.state.settings?.limits?.[key] ?? null;

  function trial() {
    const merged = { ...server() };
    for (const [key, { value }] of waiting) merged[key] = value;
    return merged;
  }

  function set(key, value) {
    if (value === undefined || (typeof value === "number" && !known(value))) return;
    let next = value;
    const range = limits(key);
    if (range) next = Math.min(range[1], Math.max(range[0], value));
    if (key === "heading") next = ((value % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI);
    if (same(trial()[key], next)) return;
    if (!send({ command: "trial", [key]: next })) return;
    waiting.set(key, { value: next, at: performance.now() });
    watchers.forEach((watch) => watch());
  }

  // Steps go to whole degrees: from 041.5 one step to starboard is 042, as on a knob with stops.
  function turn(steps, big = false) {
    const mode = MODES[trial().mode];
    if (!mode?.key) return;
    const size = big ? mode.big : mode.step;
    const now = trial()[mode.key] ?? model.state.own?.[mode.key === "heading" ? "psi" : mode.key] ?? 0;
    const stops = now / size;
    const near = Math.round(stops);
    const next = big || Math.abs(stops - near) < 1e-6 ? stops + steps : steps > 0 ? Math.floor(stops) + steps : Math.ceil(stops) + steps;
    set(mode.key, next * size);
  }

  function turnLimit(steps) {
    const now = trial().rudder_limit;
    if (known(now)) set("rudder_limit", Math.round(now / DEG + steps) * DEG);
  }

  model.watch((state, changed) => {
    if (!changed.has("settings") && !waiting.size) return;
    for (const [key, { value, at }] of waiting) {
      if (same(server()[key], value) || performance.now() - at > PATIENCE) waiting.delete(key);
    }
  });

  return {
    trial, set, turn, turnLimit, limits,
    /** Go back to the server's settings, after it refused. */
    drop: () => waiting.clear(),
    executed: () => model.state.settings?.executed ?? null,
    possible: () => model.state.settings?.modes ?? [],
    /** Call a function whenever the navigator turned something. */
    turned: (watch) => watchers.push(watch),
    /** How far the ship has to turn, in rad, positive to starboard; null where it is not known. */
    change() {
      const from = model.state.own?.psi;
      return known(from) && known(trial().heading) ? halfTurn(trial().heading - from) : null;
    },
  };
}
