// How the prediction corrects itself: the estimated coefficients with their spread and recent course, and the health of the filter.

import { el, mark, put, svg } from "../dom.js";
import { coefficient, known, uncertain } from "../figures.js";

const HEALTH = { starting: "starting", well: "well", doubtful: "doubtful", diverged: "diverged", lost: "lost" };
/** Points of a trend, and the seconds of ship's time between two of them. */
const [LENGTH, EVERY] = [240, 2];
const [WIDTH, HEIGHT] = [280, 34];

function makeTrend() {
  const [spread, course, truth] = [svg("polygon", { class: "spread" }), svg("polyline", { class: "course" }), svg("line", { class: "truth", x1: 0, x2: WIDTH })];
  const drawing = svg("svg", { class: "trend", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", "aria-hidden": "true" }, spread, truth, course);
  return { drawing, spread, course, truth };
}

// The course of a value with one standard deviation to each side, between the extremes of the value itself.
function plot({ drawing, spread, course, truth }, points, true_value) {
  drawing.toggleAttribute("hidden", points.length < 2);
  if (points.length < 2) return;
  const seen = points.map(({ value }) => value).concat(known(true_value) ? [true_value] : []);
  const [low, high] = [Math.min(...seen), Math.max(...seen)];
  const room = Math.max(high - low, 0.02 * Math.abs(high), 1e-9);
  const x = (i) => (i / (points.length - 1) * WIDTH).toFixed(1);
  const y = (value) => Math.max(-50, Math.min(HEIGHT + 50, HEIGHT - 5 - (value - (high + low - room) / 2) / room * (HEIGHT - 10))).toFixed(1);
  mark(course, "points", points.map(({ value }, i) => `${x(i)},${y(value)}`).join(" "));
  const edge = (sign) => points.map(({ value, sd }, i) => `${x(i)},${y(value + sign * (sd ?? 0))}`);
  mark(spread, "points", [...edge(1), ...edge(-1).reverse()].join(" "));
  mark(truth, "visibility", known(true_value) ? "visible" : "hidden");
  if (known(true_value)) {
    mark(truth, "y1", y(true_value));
    mark(truth, "y2", y(true_value));
  }
}

const GREEK = { tau: "τ", rho: "ρ", gamma: "γ", alpha: "α", delta: "δ", psi: "ψ" };

/** Set a symbol: Greek letters for their names, a subscript after the low line. */
export function typeset(label) {
  const [base, ...below] = label.replace(/[a-z]+/gi, (word) => GREEK[word] ?? word).split("_");
  return below.length ? [base, el("sub", {}, below.join(" "))] : [base];
}

/** Return the part of the drawer that shows the adaptation. */
export function createAdaptation() {
  const state = el("b");
  const message = el("span", { class: "soft" });
  const health = el("p", { class: "health", role: "status" }, "Filter", state, message);
  const list = el("div");
  const section = el("section", {}, el("h2", {}, "Adaptation"), health, list);
  const rows = new Map();
  const courses = new Map();

  function row(item) {
    if (!rows.has(item.name)) {
      const [symbol, number, spread, standing] = [el("span", { class: "symbol" }), el("span"), el("small"), el("span", { class: "soft" })];
      const trend = makeTrend();
      const box = el("div", { class: "estimate", role: "group" }, symbol, el("span", { class: "number" }, number, spread), trend.drawing, standing);
      list.append(box);
      rows.set(item.name, { box, symbol, number, spread, standing, trend });
    }
    return rows.get(item.name);
  }

  return {
    section,
    /** Keep the course of every value, whether the drawer is open or not. */
    gather({ adaptation, time }, changed) {
      if (!changed.has("adaptation")) return;
      for (const { name, value, sd } of adaptation?.values ?? []) {
        if (!known(value)) continue;
        const points = courses.get(name) ?? courses.set(name, []).get(name);
        const t = time?.t ?? 0;
        if (points.length && t < points.at(-1).t) points.length = 0;
        if (points.length && t - points.at(-1).t < EVERY) continue;
        points.push({ t, value, sd: known(sd) ? sd : null });
        if (points.length > LENGTH) points.shift();
      }
    },
    show({ adaptation }) {
      const about = adaptation?.health ?? {};
      put(state, HEALTH[about.state] ?? "not known");
      health.classList.toggle("bad", ["doubtful", "diverged", "lost"].includes(about.state));
      const rejected = known(about.rejected) ? `${(about.rejected * 100).toFixed(0)} % of the measurements rejected` : "";
      put(message, [about.message?.replace(/\.$/, ""), rejected].filter(Boolean).join("; "));
      const values = adaptation?.values ?? [];
      for (const item of values) {
        const { box, symbol, number, spread, standing, trend } = row(item);
        mark(box, "aria-label", item.label);
        if (symbol.dataset.of !== item.label) {
          symbol.dataset.of = item.label;
          symbol.replaceChildren(...typeset(item.label));
        }
        const [figure, deviation] = uncertain(item.value, item.sd);
        put(number, figure);
        const unit = item.unit && item.unit !== "1" ? ` ${item.unit}` : "";
        put(spread, `${deviation}${unit}`);
        put(standing, [item.standing, known(item.truth) ? `true value ${coefficient(item.truth)}` : ""].filter(Boolean).join(", "));
        plot(trend, courses.get(item.name) ?? [], item.truth);
      }
      const names = new Set(values.map(({ name }) => name));
      for (const [name, { box }] of rows) box.hidden = !names.has(name);
    },
  };
}
