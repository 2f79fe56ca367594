// The plan view: one canvas, drawn anew from every message, own ship always in it.

import { direction, distance, halfTurn, known, MILE } from "../figures.js";
import { drawBuoys, drawChart, prepare } from "./chart.js";
import { toHeading } from "../console/settings.js";
import { readColours } from "./colours.js";
import { createLabels } from "./labels.js";
import { drawBearings, drawRings, drawTrialHeading, drawVrm, labelRings } from "./marks.js";
import { projection } from "./projection.js";
import { drawRoute, labelRoute } from "./route.js";
import { drawOwn, drawTarget, drawVector } from "./ship.js";
import { drawPast, drawTrack } from "./tracks.js";

export const RANGES = [1, 2, 4, 8];
export const ORIENTATIONS = { north: "North up", head: "Head up", course: "Course up" };
export const MARKERS = {
  rings: ["Rings", "Range rings and bearings"], heading: ["Heading", "Heading line"], trial: ["Trial", "Trial heading marker"],
  vector: ["Vector", "Ground-speed vector"], vrm: ["VRM", "Variable range marker"], past: ["Past", "Past track"],
  band: ["Band", "Bands of the predicted tracks"], ships: ["Ships", "Other ships"], chart: ["Chart", "Chart"],
};
/** How far ahead vectors reach, in s, by range: a vector stays on the screen. */
const VECTOR = { 1: 180, 2: 360, 4: 360, 8: 720 };
const SHELF = "shipid-bridge-plan";

function remembered() {
  const plain = { range: 2, orientation: "north", markers: Object.fromEntries(Object.keys(MARKERS).map((name) => [name, name !== "vrm"])), vrm: { range: MILE, bearing: 0 } };
  try {
    const kept = JSON.parse(localStorage.getItem(SHELF)) ?? {};
    if (RANGES.includes(kept.range)) plain.range = kept.range;
    if (kept.orientation in ORIENTATIONS) plain.orientation = kept.orientation;
    for (const name of Object.keys(MARKERS)) if (typeof kept.markers?.[name] === "boolean") plain.markers[name] = kept.markers[name];
    if (kept.vrm?.range > 0 && known(kept.vrm.bearing)) plain.vrm = { range: kept.vrm.range, bearing: kept.vrm.bearing };
  } catch { /* Nothing stored, or nothing that can be read: the plain view. */ }
  return plain;
}

/** What the experiment lets the navigator see: the vector in B, the prediction in C, neither in A, all of it elsewhere. */
export function allowed(experiment) {
  const condition = experiment?.condition;
  return { vector: !condition || condition === "B" || condition === "D", tracks: !condition || condition === "C" || condition === "D" };
}

/** Return the plan view. */
export function createPlan(model, settings) {
  const canvas = document.getElementById("plan");
  const ctx = canvas.getContext("2d");
  const [trialMark, note, scaleNote, vrmNote] = ["trial-mark", "plan-note", "scale-note", "vrm-note"].map((id) => document.getElementById(id));
  const view = remembered();
  const watchers = [];
  let colours = readColours();
  let chart = null;
  let last = { x: 0, y: 0 };

  function frame() {
    const { width, height } = canvas.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, width, height);
    return { width, height, ratio };
  }

  function upward({ own, route }) {
    if (view.orientation === "head") return own?.psi ?? 0;
    if (view.orientation !== "course") return 0;
    const [from, to] = [route?.waypoints[route.leg], route?.waypoints[route.leg + 1]];
    if (from && to) return Math.atan2(to.y - from.y, to.x - from.x);
    return settings.executed()?.heading ?? own?.psi ?? 0;
  }

  function projected(state, size) {
    const { own } = state;
    if (known(own?.x) && known(own?.y)) last = { x: own.x, y: own.y };
    const radius = Math.max(20, Math.min(size.width, size.height) / 2 - 16);
    // What lies ahead matters more than what lies behind, where it is known where ahead is.
    const lower = view.orientation === "north" ? 0.5 : 0.5 + Math.max(0, 0.66 - 0.5) * Math.min(1, size.height / size.width);
    const at = { x: size.width / 2, y: size.height * lower };
    return { radius, look: projection({ place: last, at, scale: radius / (view.range * MILE), up: upward(state) }) };
  }

  function draw() {
    const { state, past, link } = model;
    if (!link.heard || canvas.clientWidth === 0) return;
    const size = frame();
    const { radius, look } = projected(state, size);
    const { own, route, tracks = {}, ship } = state;
    const here = known(own?.x) && known(own?.y);
    const centre = [look.at.x, look.at.y];
    const may = allowed(state.experiment);
    const { markers } = view;
    const reserved = [[0, 0, 130, 44], [size.width - 190, 0, 190, 44], [0, size.height - 30, markers.vrm ? 200 : 0, 30], [size.width - 160, size.height - 110, 160, 110]];
    const labels = createLabels(ctx, size.width, size.height, colours.sea, size.width > 500 ? reserved : reserved.slice(0, 3));

    const trial = settings.trial();
    const tried = markers.trial && here && toHeading(trial.mode) && known(trial.heading);
    if (here) labels.keep(centre, 12);
    for (const point of [...(route?.waypoints ?? []), ...(markers.ships ? state.targets ?? [] : []), ...(markers.chart ? chart?.buoys ?? [] : [])]) {
      if (known(point.x) && known(point.y)) labels.keep(look.point(point.x, point.y), 6);
    }
    if (tried) labels.keep(look.offset(centre, trial.heading, radius + 8), 12);
    if (markers.chart) drawChart(ctx, look, chart, colours, size.ratio);
    if (markers.rings) {
      drawRings(ctx, centre, radius, colours);
      drawBearings(ctx, look, centre, radius, colours, labels);
    }
    if (route) drawRoute(ctx, look, route, colours);
    if (markers.past) drawPast(ctx, look, past, colours, size);
    if (here) drawOwn(ctx, look, own, ship, colours, { line: markers.heading, reach: radius });
    if (tried) drawTrialHeading(ctx, look, centre, radius, trial.heading, colours);
    if (route) labelRoute(look, route, colours, labels);
    if (may.tracks && here) {
      // The times of the two tracks stand on their outer sides, so that they do not meet.
      const apart = halfTurn((trial.heading ?? 0) - (settings.executed()?.heading ?? own.psi ?? 0));
      const side = apart < 0 ? -1 : 1;
      for (const kind of ["executed", "trial"]) {
        if (tracks[kind]?.x?.length > 1) drawTrack(ctx, look, tracks[kind], { kind, side: kind === "trial" ? side : -side, band: markers.band, labels, ship, colours });
      }
    }
    if (may.vector && markers.vector && here) drawVector(ctx, look, own, VECTOR[view.range], colours.own);
    if (markers.ships) (state.targets ?? []).forEach((target) => drawTarget(ctx, look, target, VECTOR[view.range], colours, labels));
    if (markers.vrm) drawVrm(ctx, look, centre, view.vrm, Math.hypot(size.width, size.height), colours);
    if (markers.chart) drawBuoys(ctx, look, chart, colours, labels, size);
    if (markers.rings) labelRings(centre, radius, view.range, colours, labels);
    labels.paint();
    write(state, may, here);
  }

  function write({ tracks = {}, own, experiment }, may, here) {
    trialMark.hidden = !(may.tracks && tracks.trial);
    const words = [];
    if (!model.link.connected) words.push("Old picture");
    if (!here) words.push("No position");
    if (!known(own?.psi)) words.push("No heading");
    for (const kind of may.tracks ? ["executed", "trial"] : []) {
      const track = tracks[kind];
      if (track?.message) words.push(`${kind === "trial" ? "Trial" : "Prediction"}: ${track.message}`);
      else if (track?.beyond) words.push(`${kind === "trial" ? "Trial" : "Prediction"}: beyond what the model was identified on`);
    }
    note.hidden = !words.length;
    note.textContent = words.join(" · ");
    const scales = [view.markers.rings && `rings ${view.range / 4} nm`, (view.markers.vector && may.vector) && `vectors ${VECTOR[view.range] / 60} min`];
    scaleNote.replaceChildren(`${ORIENTATIONS[view.orientation]} · ${view.range} nm`, document.createElement("br"), scales.filter(Boolean).join(" · "));
    vrmNote.hidden = !view.markers.vrm;
    vrmNote.textContent = `VRM ${distance(view.vrm.range)} ${direction(view.vrm.bearing)}`;
  }

  function changed() {
    try {
      localStorage.setItem(SHELF, JSON.stringify(view));
    } catch { /* Where nothing may be stored, the view holds until the page is closed. */ }
    watchers.forEach((watch) => watch(view));
    draw();
  }

  const plan = {
    view, draw,
    watch(watch) {
      watchers.push(watch);
      watch(view);
    },
    setRange(miles) {
      view.range = miles;
      changed();
    },
    changeRange(step) {
      plan.setRange(RANGES[Math.max(0, Math.min(RANGES.length - 1, RANGES.indexOf(view.range) + step))]);
    },
    setOrientation(name) {
      view.orientation = name;
      changed();
    },
    toggle(name) {
      view.markers[name] = !view.markers[name];
      changed();
    },
    setVrm(part) {
      Object.assign(view.vrm, part);
      view.markers.vrm = true;
      changed();
    },
    setChart(next) {
      chart = prepare(next);
      draw();
    },
    repaint() {
      colours = readColours();
      draw();
    },
    hasChart: () => chart !== null,
  };

  // A press on the plan view sets the variable range marker there; its fields do the same by numbers.
  canvas.addEventListener("click", (event) => {
    const box = canvas.getBoundingClientRect();
    const { look } = projected(model.state, box);
    const point = look.world(event.clientX - box.left, event.clientY - box.top);
    const [north, east] = [point.x - last.x, point.y - last.y];
    plan.setVrm({ range: Math.hypot(north, east), bearing: halfTurn(Math.atan2(east, north)) });
  });
  let rolled = 0;
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (event.timeStamp - rolled < 250) return;
    rolled = event.timeStamp;
    plan.changeRange(event.deltaY > 0 ? 1 : -1);
  }, { passive: false });
  new ResizeObserver(draw).observe(canvas);
  return plan;
}
