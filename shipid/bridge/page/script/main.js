// The bridge: every part of the page, and the order in which a message reaches them.

import { createConsole } from "./console/console.js";
import { createKeys } from "./console/keys.js";
import { createSettings } from "./console/settings.js";
import { createDrawer } from "./drawer/drawer.js";
import { createBars } from "./instruments/bars.js";
import { createReadouts } from "./instruments/readouts.js";
import { createVoyage } from "./instruments/voyage.js";
import { createAlarms } from "./notices/alarms.js";
import { createAnnouncer } from "./notices/announce.js";
import { createLost } from "./notices/lost.js";
import { createMasthead, createPalettes } from "./notices/masthead.js";
import { createPlan } from "./plan/plan.js";
import { createLegend, createPlanKeys } from "./plan/plan_keys.js";
import { connect } from "./wire/connection.js";
import { createModel } from "./wire/model.js";

const model = createModel();
let connection = null;
const send = (command) => connection?.send(command) ?? false;

const settings = createSettings(model, send);
const plan = createPlan(model, settings);
const planKeys = createPlanKeys(plan);
const legend = createLegend(plan);
const desk = createConsole(model, settings, send);
const drawer = createDrawer(model, send, plan);
const [readouts, bars, voyage, masthead] = [createReadouts(model), createBars(model), createVoyage(), createMasthead()];
const [alarms, announce, lost] = [createAlarms(send), createAnnouncer(), createLost(model)];

createPalettes(plan.repaint);
createKeys({ settings, console: desk, plan, letters: drawer.letters });

function show(state, changed) {
  masthead(state);
  readouts(state);
  bars(state);
  voyage(state);
  desk.show();
  alarms(state);
  drawer.show(state, changed);
  planKeys.show(state);
  legend(state);
  plan.draw();
  announce(state);
}
model.watch(show);
settings.turned(plan.draw);
plan.watch(() => legend(model.state));

model.link.reply = ({ command, ok, message }) => {
  if (!ok && command !== "acknowledge") settings.drop();
  desk.say(ok && !message ? "" : message ?? `The server refused: ${command}.`);
};

async function fetchChart() {
  const answer = await fetch(`chart.json${location.search}`);
  if (answer.ok) plan.setChart(await answer.json());
}

connection = connect(model, () => {
  lost();
  if (model.link.heard) show(model.state, new Set());
});
fetchChart().catch(() => { /* Without a chart the plan view is drawn on open water. */ });
