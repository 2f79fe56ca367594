// The keys of the plan view: range, orientation, the variable range marker, a switch for every marker; and what the lines mean.

import { el, mark, segments, svg } from "../dom.js";
import { DEG, degrees, known, MILE, plain } from "../figures.js";
import { createField } from "../console/fields.js";
import { allowed, MARKERS, ORIENTATIONS, RANGES } from "./plan.js";

const LINES = { executed: "predicted", trial: "trial", route: "planned track", past: "past track", vector: "over the ground" };

function group(name, ...parts) {
  return el("div", { class: "group" }, el("span", { class: "label" }, name), ...parts);
}

/** Fill the bar below the plan view and keep it true to the view. */
export function createPlanKeys(plan) {
  const row = (name) => el("div", { class: "segments", role: "radiogroup", "aria-label": name });
  const [ranges, ups] = [row("Range"), row("Orientation")];
  const rangeKeys = segments(ranges, RANGES.map((value) => ({ value, text: String(value), name: `Range ${value} nautical miles` })), plan.setRange);
  const upKeys = segments(ups, Object.entries(ORIENTATIONS).map(([value, text]) => ({ value, text })), plan.setOrientation);
  const range = createField({ label: "Range of the variable range marker", unit: "nm", give: (n) => plan.setVrm({ range: n * MILE }), fits: (n) => n > 0 && n <= 100 });
  const bearing = createField({ label: "Bearing of the variable range marker", unit: "°", give: (n) => plan.setVrm({ bearing: n * DEG }), fits: (n) => n >= 0 && n <= 360 });
  const switches = Object.entries(MARKERS).map(([name, [text, title]]) => {
    const key = el("button", { type: "button", title, "aria-label": title }, text);
    key.addEventListener("click", () => plan.toggle(name));
    return { name, key };
  });
  const markers = el("div", { class: "group markers", role: "group", "aria-label": "Markers" }, el("span", { class: "label" }, "Show"), ...switches.map(({ key }) => key));
  document.getElementById("plan-keys").append(
    group("Range, nm", ranges), el("div", { class: "group" }, ups), group("VRM", range.box, bearing.box), markers,
  );
  plan.watch((view) => {
    rangeKeys.show(view.range);
    upKeys.show(view.orientation);
    range.show(plain(view.vrm.range / MILE, 2));
    bearing.show(degrees(view.vrm.bearing));
    for (const { name, key } of switches) mark(key, "aria-pressed", view.markers[name] ? "true" : "false");
  });
  return {
    /** Hide the switches of what there is nothing of. */
    show(state) {
      const may = allowed(state.experiment);
      const there = { chart: plan.hasChart(), vector: may.vector, band: may.tracks, ships: (state.targets ?? []).length > 0 };
      for (const { name, key } of switches) key.hidden = there[name] === false;
    },
  };
}

/** Return a function that shows what the lines of the plan view mean, those that are there. */
export function createLegend(plan) {
  const items = Object.entries(LINES).map(([name, text]) => {
    const item = el("li", { class: name }, text, svg("svg", { viewBox: "0 0 34 10", "aria-hidden": "true" }, svg("line", { x1: 1, x2: 33, y1: 5, y2: 5 })));
    return { name, item };
  });
  document.getElementById("legend").append(...items.map(({ item }) => item));
  return (state) => {
    const may = allowed(state.experiment);
    const there = {
      executed: may.tracks && state.tracks?.executed, trial: may.tracks && state.tracks?.trial, route: state.route,
      past: plan.view.markers.past, vector: may.vector && plan.view.markers.vector && known(state.own?.x) && known(state.own?.cog) && known(state.own?.sog),
    };
    for (const { name, item } of items) item.hidden = !there[name];
  };
}
