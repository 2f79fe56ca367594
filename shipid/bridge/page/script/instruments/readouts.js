// The numbers at the top: heading, courses and speeds, the wheel-over and the distance off the track.

import { el, mark, put } from "../dom.js";
import { age, aside, clock, DASH, degrees, distance, known, knots } from "../figures.js";

/** After so many seconds a state of the ship is no longer shown as if it were now. */
export const OLD = 2;

const SHIP = [
  { key: "psi", name: "HDG", full: "heading", measure: "°", text: degrees, sensors: ["psi"] },
  { key: "cog", name: "COG", full: "course over ground", measure: "°", text: degrees, sensors: ["COG"] },
  { key: "stw", name: "STW", full: "speed through the water", measure: "kn", text: knots, sensors: ["u"] },
  { key: "sog", name: "SOG", full: "speed over ground", measure: "kn", text: knots, sensors: ["SOG"] },
];

/** Say how a value of the ship stands: its age where it is too old to be used, whether it is estimated. */
export function standing(model, key, sensors = [key]) {
  const { state, link } = model;
  const own = state.own ?? {};
  const estimated = (own.estimated ?? []).includes(key);
  const silence = link.connected ? 0 : model.silence();
  const whole = (known(own.age) ? own.age : 0) + silence;
  if (whole > OLD || !link.connected) return { old: true, age: whole, estimated };
  const lost = (state.sensors ?? []).find((s) => sensors.includes(s.name) && s.lost);
  if (lost && !estimated) return { old: true, age: known(lost.age) ? lost.age : null, estimated };
  return { old: false, age: null, estimated };
}

/** Mark a number as old or estimated, and write beside it what it is. A dash is not struck: there is nothing to mistrust. */
export function qualify(value, note, how, there = true) {
  value.classList.toggle("old", how.old && there);
  value.classList.toggle("estimated", how.estimated && there);
  note.classList.toggle("age", how.old);
  put(note, how.old ? (how.age === null ? "lost" : `${age(how.age)} old`) : how.estimated && there ? "est." : "");
  mark(note, "title", how.old ? "older than its limit" : how.estimated && there ? "estimated, not measured" : null);
}

function makeReadout(name, full) {
  const note = el("span", { class: "note" });
  const number = el("span", { class: "number" });
  const unit = el("small");
  const box = el("div", { class: "readout", role: "group", "aria-label": full },
    el("div", { class: "name" }, el("abbr", { title: full }, name), note),
    el("div", { class: "value" }, number, unit));
  return { box, note, number, unit };
}

/** Return a function that shows the readouts. */
export function createReadouts(model) {
  const holder = document.getElementById("readouts");
  const ship = SHIP.map((item) => ({ ...item, ...makeReadout(item.name, item.full) }));
  const over = makeReadout("Wheel-over", "time and distance to the wheel-over");
  const off = makeReadout("Off track", "distance off the track, P to port, S to starboard");
  holder.append(...ship.map(({ box }) => box), over.box, off.box);

  return (state) => {
    for (const item of ship) {
      put(item.number, item.text(state.own?.[item.key]));
      put(item.unit, item.measure);
      qualify(item.number, item.note, standing(model, item.key, item.sensors), known(state.own?.[item.key]));
    }
    const route = state.route;
    const wheel = route?.wheel_over;
    put(over.number, wheel ? clock(wheel.seconds) : DASH);
    put(over.unit, wheel ? distance(wheel.distance) : route ? "" : "no route");
    put(off.number, route ? aside(route.off_track) : DASH);
    // Both are reckoned from the position: without fixes they are as old, or as much an estimate, as that is.
    const place = standing(model, "x", ["position"]);
    qualify(over.number, over.note, place, Boolean(wheel));
    qualify(off.number, off.note, place, Boolean(route) && known(route.off_track));
    if (!wheel) put(over.note, "");
    if (!route) put(off.note, "");
    if (wheel && wheel.seconds < 0 && !place.old) put(over.note, "past");
  };
}
