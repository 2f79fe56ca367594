// The heading selector: a compass on which the trial heading is a marker that is turned by keys, by the pointer or by a press.

import { mark, svg } from "../dom.js";
import { DEG, degrees, halfTurn, known } from "../figures.js";
import { toHeading } from "./settings.js";

const RIM = 76;

const polar = (radius, angle) => [radius * Math.sin(angle), -radius * Math.cos(angle)];

function rose() {
  const parts = [svg("circle", { class: "dish", r: RIM })];
  for (let d = 0; d < 360; d += 10) {
    const long = d % 30 === 0;
    const [x1, y1] = polar(RIM, d * DEG);
    const [x2, y2] = polar(RIM - (long ? 9 : 5), d * DEG);
    parts.push(svg("line", { class: long ? "tick long" : "tick", x1, y1, x2, y2 }));
    if (!long) continue;
    const [x, y] = polar(RIM - 19, d * DEG);
    const text = svg("text", { x, y: y + 4, class: d === 0 ? "north" : "" });
    text.textContent = d === 0 ? "N" : String(d).padStart(3, "0");
    parts.push(text);
  }
  return parts;
}

// The turn that is being tried, as an arc from the heading to the trial heading.
function arc(from, to) {
  const turn = halfTurn(to - from);
  const [a, b] = [polar(RIM - 34, from), polar(RIM - 34, from + turn)];
  const numbers = [...a, ...b].map((n) => n.toFixed(2));
  return `M${numbers[0]} ${numbers[1]} A${RIM - 34} ${RIM - 34} 0 0 ${turn > 0 ? 1 : 0} ${numbers[2]} ${numbers[3]}`;
}

/** Return the dial and a function that shows it. */
export function createCompass(model, settings) {
  const ship = svg("g", {}, svg("path", { class: "hull", d: "M0 -20 C5 -12 6 -6 6 16 L-6 16 C-6 -6 -5 -12 0 -20 Z" }), svg("line", { class: "line", y1: -20, y2: -(RIM - 28) }));
  const executed = svg("path", { class: "bug executed", d: `M0 ${-RIM} l6 9 l-12 0 Z` });
  const letter = svg("text", { class: "letter" });
  letter.textContent = "T";
  const trial = svg("path", { class: "bug trial", d: `M0 ${-RIM} l10 -18 l-20 0 Z` });
  const turning = svg("path", { class: "turning" });
  const dial = svg("svg", { class: "compass", viewBox: "-95 -95 190 190", role: "slider", tabindex: 0, "aria-label": "Trial heading", "aria-valuemin": 0, "aria-valuemax": 359.9 },
    ...rose(), turning, ship, executed, trial, letter);

  let held = false;
  let sent = 0;
  function point(event) {
    const box = dial.getBoundingClientRect();
    const angle = Math.atan2(event.clientX - box.left - box.width / 2, -(event.clientY - box.top - box.height / 2));
    settings.set("heading", Math.round(angle / DEG) * DEG);
  }
  dial.addEventListener("pointerdown", (event) => {
    if (dial.getAttribute("aria-disabled") === "true") return;
    held = true;
    dial.setPointerCapture(event.pointerId);
    point(event);
  });
  dial.addEventListener("pointermove", (event) => {
    if (!held || event.timeStamp - sent < 40) return;
    sent = event.timeStamp;
    point(event);
  });
  dial.addEventListener("pointerup", (event) => {
    if (held) point(event);
    held = false;
  });
  dial.addEventListener("pointercancel", () => { held = false; });

  function show() {
    const { mode, heading } = settings.trial();
    const psi = model.state.own?.psi;
    const done = settings.executed();
    const usable = toHeading(mode) && known(heading);
    mark(dial, "aria-disabled", usable ? "false" : "true");
    mark(dial, "aria-valuenow", known(heading) ? degrees(heading) : 0);
    mark(dial, "aria-valuetext", known(heading) ? `${degrees(heading)} degrees` : "not known");
    const at = (node, angle) => {
      mark(node, "visibility", known(angle) ? "visible" : "hidden");
      if (known(angle)) mark(node, "transform", `rotate(${(angle / DEG).toFixed(1)})`);
    };
    at(ship, psi);
    at(trial, heading);
    mark(letter, "visibility", known(heading) ? "visible" : "hidden");
    if (known(heading)) {
      // The letter stays upright wherever the marker stands.
      const [x, y] = polar(RIM + 12, heading);
      mark(letter, "x", x.toFixed(1));
      mark(letter, "y", (y + 4).toFixed(1));
    }
    at(executed, toHeading(done?.mode) ? done.heading : null);
    const apart = usable && known(psi) && Math.abs(halfTurn(heading - psi)) > 0.5 * DEG;
    mark(turning, "visibility", apart ? "visible" : "hidden");
    if (apart) mark(turning, "d", arc(psi, heading));
  }
  return { dial, show };
}
