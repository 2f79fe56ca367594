// What the navigator keeps in mind: the next course, what the turn will miss, current and wind, the recording.

import { el, put } from "../dom.js";
import { direction, distance, known, knots, perMinute, plain, KNOT } from "../figures.js";

function current(flow) {
  if (!flow || !known(flow.speed)) return null;
  const spread = known(flow.sd) ? ` ± ${plain(flow.sd / KNOT, 1)}` : "";
  // A current that may as well be none has no direction.
  const to = flow.speed < 2 * (flow.sd ?? 0) ? ", direction not known" : ` to ${direction(flow.direction_to)}`;
  return `${knots(flow.speed)}${spread} kn${to}`;
}

function wind(flow) {
  if (!flow || !known(flow.speed)) return null;
  const speed = `${plain(flow.speed, 1)} m/s`;
  return flow.speed < 0.05 ? speed : `${speed} from ${direction(flow.direction_from)}`;
}

function leg(route) {
  const count = route.waypoints.length - 1;
  const towards = route.waypoints[route.leg + 1];
  return `${route.leg + 1} of ${count}${towards?.name ? `, to ${towards.name}` : ""}`;
}

function recording({ file, samples, message }) {
  if (message) return message;
  return file ? `${file}, ${samples.toLocaleString("en").replaceAll(",", " ")} samples` : "off";
}

/** Return a function that shows the rows that there is something to say about. */
export function createVoyage() {
  const holder = document.getElementById("voyage");
  const rows = new Map();

  function row(name, text) {
    if (!rows.has(name)) {
      const [term, value] = [el("dt", {}, name), el("dd")];
      rows.set(name, { term, value });
      holder.append(term, value);
    }
    const { term, value } = rows.get(name);
    term.hidden = value.hidden = text === null;
    if (text !== null) put(value, text);
  }

  return ({ route, flow = {}, recording: record, experiment }) => {
    row("Leg", route ? leg(route) : null);
    row("Next heading", known(route?.wheel_over?.course) ? direction(route.wheel_over.course) : null);
    row("Overshoot of the plan", known(route?.overshoot) ? distance(route.overshoot) : null);
    row("Current, estimated", current(flow.current) ?? "not known");
    const measured = flow.wind?.measured ? "Wind, measured" : "Wind, estimated";
    const other = flow.wind?.measured ? "Wind, estimated" : "Wind, measured";
    row(measured, wind(flow.wind) ?? "not known");
    row(other, null);
    row("Spread of the rate of turn", known(experiment?.spread) ? `${perMinute(experiment.spread)}°/min` : null);
    row("Recording", record ? recording(record) : null);
  };
}
