// The console: mode, heading selector, field with its steps, rudder limit, EXECUTE and CANCEL, what is executed.

import { el, mark, put, segments } from "../dom.js";
import { DEG, direction, known, plain } from "../figures.js";
import { createCompass } from "./compass.js";
import { createExecute } from "./execute.js";
import { createField } from "./fields.js";
import { inWords, MODES } from "./settings.js";

const STEPS = [[-1, true], [-1, false], [1, false], [1, true]];

function stepKey(settings, way, big) {
  const text = `${way < 0 ? "−" : "+"}${big ? 5 : 1}`;
  const key = el("button", { type: "button" }, text);
  key.addEventListener("click", () => settings.turn(way, big));
  return { key, way, size: big ? 5 : 1 };
}

/** Return the console: its deeds, and a function that shows it. */
export function createConsole(model, settings, send) {
  const holder = document.getElementById("settings");
  const modes = el("div", { class: "segments wide", role: "radiogroup", "aria-label": "Mode" });
  const modeKeys = segments(modes, Object.entries(MODES).map(([value, { name }]) => ({ value, text: name })), (value) => settings.set("mode", value));
  const message = el("p", { class: "message", role: "status", hidden: true });
  const say = (text) => { put(message, text); message.hidden = !text; };

  const compass = createCompass(model, settings);
  const label = el("span", { class: "label" });
  const main = createField({ label: "Trial heading", give: (number) => settings.set(current().key, current().read(number)), fail: say, steps: (n) => settings.turn(n) });
  main.box.classList.add("primary");
  const steps = STEPS.map(([way, big]) => stepKey(settings, way, big));
  const stepRow = el("div", { class: "steps" }, ...steps.map(({ key }) => key));
  const follow = el("p", { class: "follow" });

  const limit = createField({
    label: "Trial rudder limit", unit: "°", give: (number) => settings.set("rudder_limit", number * DEG), fail: say,
    fits: (number) => number > 0, hint: "A rudder limit is a number of degrees above 0.", steps: (n) => settings.turnLimit(n),
  });
  const [less, more] = [-1, 1].map((way) => {
    const key = el("button", { type: "button", "aria-label": `Trial rudder limit ${way} degree` }, way < 0 ? "−" : "+");
    key.addEventListener("click", () => settings.turnLimit(way));
    return key;
  });
  const limitRow = el("div", { class: "field" }, less, limit.box, more);
  const limitLabel = el("span", { class: "label" }, "Trial rudder limit");

  const execute = el("button", { type: "button", class: "execute", "aria-pressed": "false" }, "EXECUTE");
  const cancel = el("button", { type: "button" }, "CANCEL");
  const region = el("p", { class: "unseen", "aria-live": "polite" });
  const deed = createExecute(model, settings, send, { execute, cancel, region });
  const executed = el("b");

  holder.append(
    modes,
    el("div", { class: "trial" }, compass.dial, el("div", { class: "fields" }, label, main.box, stepRow, follow, limitLabel, limitRow)),
    message,
    el("div", { class: "deeds" }, execute, cancel),
    el("p", { class: "executed" }, "Executed: ", executed),
    region,
  );

  let mode = null;
  const current = () => MODES[settings.trial().mode] ?? MODES.heading;

  function change(next) {
    mode = next;
    const what = current();
    put(label, what.label);
    main.become(what.key ? { label: what.label, unit: what.unit, fits: what.fits, hint: what.hint } : { label: what.label, unit: "" });
    main.box.hidden = stepRow.hidden = !what.key;
    follow.hidden = Boolean(what.key);
    for (const { key, way, size } of steps) mark(key, "aria-label", `${what.label} ${way < 0 ? "minus" : "plus"} ${size}`);
    limitRow.hidden = limitLabel.hidden = next === "rudder";
  }

  function show() {
    const trial = settings.trial();
    if (trial.mode !== mode) change(trial.mode);
    modeKeys.show(trial.mode);
    modeKeys.allow(model.link.connected ? settings.possible() : []);
    const what = current();
    if (what.key) main.show(known(trial[what.key]) ? what.write(trial[what.key]) : "");
    const next = model.state.route?.wheel_over?.course;
    put(follow, known(next) ? `next ${direction(next)}` : "keeps the track");
    limit.show(known(trial.rudder_limit) ? plain(trial.rudder_limit / DEG, 0) : "");
    for (const part of [main, limit]) part.use(model.link.connected);
    for (const key of [...steps.map((s) => s.key), less, more]) key.disabled = !model.link.connected;
    compass.show();
    deed.show();
    put(executed, inWords(settings.executed()));
  }

  settings.turned(show);
  return { show, say, execute: deed.press, cancel: deed.back };
}
