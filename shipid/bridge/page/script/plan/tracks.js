// The predicted tracks, with bands and time ticks, and the past one. Trial is dashed and executed solid, whatever the colour.

import { pixels, trace } from "./projection.js";
import { hull } from "./ship.js";

const TICKS = [10, 20, 30, 60, 120, 300, 600, 1200];
/** Pixels that two time ticks, and two dots of the past track, keep apart at least. */
const [APART, DOTS] = [24, 7];
/** Pixels that two written times keep apart at least. */
const NUMBERED = 34;

// One side of the band and back on the other, square to the track.
function bandOf(view, track) {
  const { x, y, half_width: half } = track;
  if (!half) return [];
  const sides = [[], []];
  for (let i = 0; i < x.length; i++) {
    const [a, b] = [Math.max(0, i - 1), Math.min(x.length - 1, i + 1)];
    const [dx, dy] = [x[b] - x[a], y[b] - y[a]];
    const size = Math.hypot(dx, dy);
    if (!(size > 0) || !Number.isFinite(half[i])) continue;
    const [nx, ny] = [-dy / size * half[i], dx / size * half[i]];
    sides[0].push(view.point(x[i] + nx, y[i] + ny));
    sides[1].push(view.point(x[i] - nx, y[i] - ny));
  }
  return [...sides[0], ...sides[1].reverse()];
}

/** Choose which time ticks have their time written: those at a multiple of the answer, in s. */
export function numberStep(step, seconds, length) {
  return TICKS.find((candidate) => candidate % step === 0 && candidate / seconds * length >= NUMBERED) ?? Infinity;
}

/** Choose how far apart time ticks stand, in s. */
export function tickStep(seconds, length) {
  if (!(seconds > 0) || !(length > 0)) return TICKS.at(-1);
  return TICKS.find((step) => step / seconds * length >= APART) ?? TICKS.at(-1);
}

/** Return the places of a track at whole time ticks: {t, x, y, slope} in the world. */
export function ticksOf(track, step) {
  const { x, y, t } = track;
  const found = [];
  for (let i = 1; i < t.length; i++) {
    for (let next = (found.length + 1) * step; t[i] >= next && t[i] > t[i - 1]; next += step) {
      const share = (next - t[i - 1]) / (t[i] - t[i - 1]);
      const between = (values) => values[i - 1] + share * (values[i] - values[i - 1]);
      found.push({ t: next, x: between(x), y: between(y), slope: Math.atan2(y[i] - y[i - 1], x[i] - x[i - 1]) });
    }
  }
  return found;
}

/** Draw a predicted track; its times stand to starboard of it where `side` is 1, to port where it is −1. */
export function drawTrack(ctx, view, track, { kind, side, band, labels, ship, colours }) {
  const colour = colours[kind];
  const points = pixels(view, track.x, track.y);
  if (points.length < 2) return;
  ctx.strokeStyle = ctx.fillStyle = colour;
  const area = band ? bandOf(view, track) : [];
  if (area.length > 3) {
    trace(ctx, area, true);
    ctx.globalAlpha = kind === "executed" ? 0.2 : 0.12;
    ctx.fill();
    ctx.globalAlpha = 0.8;
    ctx.lineWidth = 1;
    ctx.setLineDash(kind === "executed" ? [] : [3, 4]);
    ctx.stroke();
    ctx.globalAlpha = 1;
  }
  trace(ctx, points);
  ctx.lineWidth = 2.5;
  ctx.lineJoin = "round";
  ctx.setLineDash(kind === "executed" ? [] : [9, 6]);
  ctx.stroke();
  ctx.setLineDash([]);

  let length = 0;
  for (let i = 1; i < points.length; i++) length += Math.hypot(points[i][0] - points[i - 1][0], points[i][1] - points[i - 1][1]);
  const step = tickStep(track.t.at(-1), length);
  const ticks = ticksOf(track, step);
  const numbers = numberStep(step, track.t.at(-1), length);
  const last = ticks.findLast(({ t }) => t % numbers === 0);
  ticks.forEach((tick) => {
    const middle = view.point(tick.x, tick.y);
    const across = tick.slope + Math.PI / 2;
    trace(ctx, [view.offset(middle, across, 6), view.offset(middle, across, -6)]);
    ctx.strokeStyle = colour;
    ctx.lineWidth = 2;
    ctx.stroke();
    if (tick.t % numbers) return;
    const whole = numbers % 60 === 0;
    const text = whole ? String(tick.t / 60) : `${Math.floor(tick.t / 60)}:${String(tick.t % 60).padStart(2, "0")}`;
    labels.beside(whole && tick === last ? `${text} min` : text, middle, across - view.up + (side < 0 ? Math.PI : 0), colour);
  });
  const end = track.x.length - 1;
  // Where she will lie: her outline at the end of the track, where it can be seen.
  if (ship.length * view.scale > 14 && Number.isFinite(track.psi?.[end])) {
    trace(ctx, hull(view, { x: track.x[end], y: track.y[end], psi: track.psi[end] }, ship), true);
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1.5;
    ctx.setLineDash(kind === "executed" ? [] : [4, 3]);
    ctx.stroke();
    ctx.setLineDash([]);
  }
}

/** Draw where the ship was, as dots. */
export function drawPast(ctx, view, past, colours, size) {
  ctx.fillStyle = colours.past;
  ctx.beginPath();
  let [lx, ly] = [Infinity, Infinity];
  for (let i = past.t.length - 1; i >= 0; i--) {
    if (!Number.isFinite(past.x[i]) || !Number.isFinite(past.y[i])) continue;
    const [x, y] = view.point(past.x[i], past.y[i]);
    if (Math.hypot(x - lx, y - ly) < DOTS) continue;
    [lx, ly] = [x, y];
    if (x < -5 || y < -5 || x > size.width + 5 || y > size.height + 5) continue;
    ctx.moveTo(x + 1.9, y);
    ctx.arc(x, y, 1.9, 0, 2 * Math.PI);
  }
  ctx.fill();
}
