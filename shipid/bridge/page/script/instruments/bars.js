// Rate of turn and rudder, one under the other with a common zero: what the ship is told, what she does, how she turns.

import { el, mark, put, svg } from "../dom.js";
import { DEG, known, perMinute, rudder, sided } from "../figures.js";
import { qualify, standing } from "./readouts.js";

const [WIDTH, TOP, HEIGHT] = [336, 6, 16];
const SCALES = [10, 15, 20, 30, 45, 60, 90, 120, 180, 300, 600];
/** The least end of the scale of the rate of turn, in degrees a minute. */
const SLOW = 30;
const MIDDLE = WIDTH / 2;
const ROOM = MIDDLE - 14;

const scaleFor = (largest) => SCALES.find((s) => s >= largest - 1e-9) ?? SCALES.at(-1);

// A scale whose numbers are multiples of a third or a half of its end.
function stepsOf(full) {
  const count = full % 3 === 0 ? 3 : 2;
  return Array.from({ length: 2 * count + 1 }, (_, i) => (i - count) * full / count);
}

function makeBar(title) {
  const heading = el("h2", {}, title);
  const numbers = el("div", { class: "numbers" });
  const drawing = svg("svg", { viewBox: `0 0 ${WIDTH} 44`, "aria-hidden": "true", preserveAspectRatio: "xMidYMid meet" });
  const scale = svg("g");
  const amount = svg("rect", { class: "amount", y: TOP + 3, height: HEIGHT - 6 });
  const now = svg("line", { class: "now", y1: TOP - 2, y2: TOP + HEIGHT + 2 });
  const wanted = svg("path", { class: "wanted", d: `M0 ${TOP + HEIGHT - 3} l7 11 l-14 0 Z` });
  drawing.append(
    svg("rect", { class: "rail", x: MIDDLE - ROOM, width: 2 * ROOM, y: TOP, height: HEIGHT, rx: 2 }),
    amount, scale, svg("line", { class: "zero", x1: MIDDLE, x2: MIDDLE, y1: TOP - 3, y2: TOP + HEIGHT + 3 }), now, wanted,
  );
  let full = 0;

  function setScale(next) {
    if (next === full) return;
    full = next;
    const marks = stepsOf(full).flatMap((value) => {
      const x = MIDDLE + value / full * ROOM;
      const text = svg("text", { x, y: TOP + HEIGHT + 18 });
      text.textContent = String(Math.abs(value));
      return [svg("line", { class: "tick", x1: x, x2: x, y1: TOP, y2: TOP + HEIGHT }), text];
    });
    const [port, starboard] = ["P", "S"].map((letter, i) => {
      const side = svg("text", { class: `side ${i ? "starboard" : "port"}`, x: i ? WIDTH - 4 : 4, y: TOP + 12 });
      side.textContent = letter;
      return side;
    });
    scale.replaceChildren(...marks, port, starboard);
  }

  function show(value, order) {
    const at = (v) => MIDDLE + Math.max(-1, Math.min(1, v / full)) * ROOM;
    for (const node of [amount, now]) mark(node, "visibility", known(value) ? "visible" : "hidden");
    if (known(value)) {
      const x = at(value);
      mark(amount, "x", Math.min(x, MIDDLE).toFixed(1));
      mark(amount, "width", Math.abs(x - MIDDLE).toFixed(1));
      mark(amount, "class", `amount ${value < 0 ? "port" : "starboard"}`);
      mark(now, "x1", x.toFixed(1));
      mark(now, "x2", x.toFixed(1));
    }
    mark(wanted, "visibility", known(order) ? "visible" : "hidden");
    if (known(order)) mark(wanted, "transform", `translate(${at(order).toFixed(1)} 0)`);
  }

  return { box: el("div", { class: "bar" }, heading, numbers, drawing), numbers, setScale, show, scale: () => full };
}

const sideClass = (value) => (!known(value) || Math.abs(value) < 0.05 ? "" : value < 0 ? "port" : "starboard");

/** Return a function that shows rate of turn and rudder. */
export function createBars(model) {
  const turning = makeBar("Rate of turn");
  const steering = makeBar("Rudder");
  const [rate, rateNote, angle, angleNote, order] = ["b", "span", "b", "span", "span"].map((name) => el(name));
  order.className = "order";
  turning.numbers.append(rateNote, " ", rate);
  steering.numbers.append(order, angleNote, " ", angle);
  document.getElementById("bars").append(turning.box, steering.box);

  return ({ own = {}, settings }) => {
    const limits = settings?.limits ?? {};
    const r = known(own.r) ? own.r / DEG * 60 : null;
    // The scale grows with the fastest turn so far: what the ship could do at most would leave the pointer near zero.
    turning.setScale(Math.max(turning.scale(), scaleFor(Math.max(SLOW, Math.abs(r ?? 0)))));
    turning.show(r, null);
    put(rate, sided(r, 1, "°/min"));
    mark(rate, "class", sideClass(r));
    mark(rate, "aria-label", `rate of turn ${perMinute(own.r)} degrees a minute`);
    qualify(rate, rateNote, standing(model, "r"), known(r));

    const delta = known(own.delta) ? own.delta / DEG : null;
    const ordered = known(own.delta_order) ? own.delta_order / DEG : null;
    const largest = Math.max(...(limits.rudder ?? [0]).map((v) => Math.abs(v) / DEG), Math.abs(delta ?? 0), 10);
    steering.setScale(Math.max(steering.scale(), scaleFor(largest)));
    steering.show(delta, ordered);
    put(angle, rudder(own.delta));
    mark(angle, "class", sideClass(delta));
    put(order, `order ${rudder(own.delta_order)}`);
    qualify(angle, angleNote, standing(model, "delta"), known(delta));
  };
}
