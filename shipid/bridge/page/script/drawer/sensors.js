// Every sensor with its value and how old that is.

import { el, put } from "../dom.js";
import { age, DASH, degrees, known, knots, perMinute, plain, rudder } from "../figures.js";

const SIDED = ["delta", "delta_order", "rudder"];

function written({ name, value, unit, age: old, lost }) {
  // A position has no one number: that it comes is what there is to say.
  if (!known(value)) return known(old) && !lost ? "received" : DASH;
  if (unit === "rad/s") return `${perMinute(value)}°/min`;
  if (unit === "rad") return SIDED.includes(name) ? rudder(value) : `${degrees(value)}°`;
  if (unit === "m/s") return name.startsWith("wind") ? `${plain(value, 1)} m/s` : `${knots(value)} kn`;
  return `${plain(value, 1)} ${unit === "1" ? "" : unit ?? ""}`.trim();
}

/** Return the part of the drawer that lists the sensors. */
export function createSensors(model) {
  const body = el("tbody");
  const section = el("section", {}, el("h2", {}, "Sensors"), el("table", {}, body));
  const rows = new Map();

  return {
    section,
    show({ sensors = [] }) {
      section.hidden = sensors.length === 0;
      const silence = model.link.connected ? 0 : model.silence();
      for (const sensor of sensors) {
        if (!rows.has(sensor.name)) {
          const cells = [el("th", { scope: "row" }, sensor.label), el("td", { class: "number" }), el("td", { class: "number soft" })];
          rows.set(sensor.name, cells);
          body.append(el("tr", {}, ...cells));
        }
        const [, value, old] = rows.get(sensor.name);
        const stale = sensor.lost || !model.link.connected;
        put(value, written(sensor));
        value.classList.toggle("old", stale);
        put(old, stale ? `lost ${known(sensor.age) ? age(sensor.age + silence) : ""}` : known(sensor.age) ? age(sensor.age) : "");
      }
      const names = new Set(sensors.map(({ name }) => name));
      for (const [name, cells] of rows) cells[0].parentElement.hidden = !names.has(name);
    },
  };
}
