// Alarms, warnings and cautions: the gravest first, told at once, acknowledged one by one.

import { el, mark, put, svg } from "../dom.js";
import { clock } from "../figures.js";

const GRAVITY = { alarm: 0, warning: 1, caution: 2 };

// Told apart by shape too: a triangle, a circle, a square.
function sign(kind) {
  const shape = {
    alarm: () => svg("path", { d: "M10 1 L19 18 L1 18 Z" }),
    warning: () => svg("circle", { cx: 10, cy: 10, r: 8.5 }),
    caution: () => svg("rect", { x: 2, y: 2, width: 16, height: 16 }),
  }[kind]();
  for (const [name, value] of Object.entries({ fill: "none", stroke: "currentColor", "stroke-width": 2 })) shape.setAttribute(name, value);
  const bang = svg("path", { d: "M10 6 L10 12 M10 14 L10 16", stroke: "currentColor", "stroke-width": 2 });
  return svg("svg", { viewBox: "0 0 20 20", "aria-hidden": "true" }, shape, bang);
}

/** Return a function that shows the list of the state; pressing a row's key acknowledges that row only. */
export function createAlarms(send) {
  const list = document.getElementById("alarms");
  const region = document.getElementById("alarm-region");
  const rows = new Map();
  const quiet = el("li", { class: "quiet" }, "No alarms");
  let title = document.title;

  function makeRow(alarm) {
    const kind = alarm.kind in GRAVITY ? alarm.kind : "alarm";
    const words = el("span", { class: "words" });
    const since = el("span", { class: "since" });
    const key = el("button", { type: "button" }, "ACK");
    key.addEventListener("click", () => send({ command: "acknowledge", id: alarm.id }));
    const item = el("li", { class: `alarm ${kind}-kind` }, sign(kind), el("span", { class: "kind" }, kind), words, since, key);
    return { item, words, since, key };
  }

  function order(alarms) {
    return [...alarms].sort((a, b) => a.acknowledged - b.acknowledged || (GRAVITY[a.kind] ?? 0) - (GRAVITY[b.kind] ?? 0) || b.since - a.since);
  }

  return (state) => {
    const alarms = order(state.alarms ?? []);
    const fresh = alarms.filter(({ id }) => !rows.has(id));
    const kept = new Set(alarms.map(({ id }) => id));
    const held = list.contains(document.activeElement);
    for (const [id, row] of rows) {
      if (kept.has(id)) continue;
      row.item.remove();
      rows.delete(id);
    }
    alarms.forEach((alarm, i) => {
      if (!rows.has(alarm.id)) rows.set(alarm.id, makeRow(alarm));
      const row = rows.get(alarm.id);
      put(row.words, alarm.text);
      put(row.since, clock(Math.max(0, (state.time?.t ?? 0) - alarm.since)));
      mark(row.since, "title", "since");
      mark(row.key, "aria-label", `Acknowledge ${alarm.kind}: ${alarm.text}`);
      row.item.classList.toggle("unseen-yet", !alarm.acknowledged);
      row.key.hidden = alarm.acknowledged;
      if (list.children[i] !== row.item) list.insertBefore(row.item, list.children[i] ?? null);
    });
    if (!alarms.length && !quiet.isConnected) list.append(quiet);
    if (alarms.length) quiet.remove();
    // Whoever acknowledges by keyboard stays at the list, at the next row that asks for it.
    if (held && !list.contains(document.activeElement)) list.querySelector("button:not([hidden])")?.focus();
    if (fresh.length) put(region, fresh.map(({ kind, text }) => `${kind}: ${text}`).join(". "));
    const waiting = alarms.filter(({ acknowledged }) => !acknowledged).length;
    if (title !== (title = waiting ? `(${waiting}) Shipid bridge` : "Shipid bridge")) document.title = title;
  };
}
