// Range rings, the scale of bearings, the markers of heading and trial heading, the variable range marker.

import { DEG, plain } from "../figures.js";
import { trace } from "./projection.js";

function circle(ctx, [x, y], radius) {
  ctx.beginPath();
  ctx.arc(x, y, radius, 0, 2 * Math.PI);
}

/** Draw four range rings, at quarters of the range. */
export function drawRings(ctx, place, radius, colours) {
  ctx.strokeStyle = colours.ring;
  ctx.setLineDash([]);
  ctx.lineWidth = 1;
  for (const share of [0.25, 0.5, 0.75, 1]) {
    ctx.globalAlpha = share === 1 ? 0.9 : 0.45;
    circle(ctx, place, radius * share);
    ctx.stroke();
  }
  ctx.globalAlpha = 1;
}

/** Write the ranges at the rings, right and below the ship. */
export function labelRings(place, radius, miles, colours, labels) {
  for (const share of [0.25, 0.5, 0.75]) {
    const side = radius * share * Math.SQRT1_2;
    labels.write(`${plain(miles * share, miles < 4 ? 2 : 0).replace(/(\.\d)0$/, "$1")}`, [place[0] + side, place[1] + side], colours.soft, { size: 11, centred: true });
  }
}

/** Draw the scale of true bearings along the outermost ring. */
export function drawBearings(ctx, view, place, radius, colours, labels) {
  ctx.strokeStyle = colours.ring;
  ctx.lineWidth = 1;
  ctx.beginPath();
  for (let d = 0; d < 360; d += 5) {
    const inner = d % 30 === 0 ? 10 : d % 10 === 0 ? 7 : 4;
    const [a, b] = [view.offset(place, d * DEG, radius), view.offset(place, d * DEG, radius - inner)];
    ctx.moveTo(...a);
    ctx.lineTo(...b);
  }
  ctx.stroke();
  for (let d = 0; d < 360; d += 30) {
    labels.write(d ? String(d).padStart(3, "0") : "N", view.offset(place, d * DEG, radius - 20), colours.soft, { size: 11, centred: true, bold: d === 0 });
  }
}

/** Draw the trial heading marker: a dashed line from the ship to a triangle with a T at the outermost ring. */
export function drawTrialHeading(ctx, view, place, radius, heading, colours) {
  ctx.strokeStyle = ctx.fillStyle = colours.trial;
  ctx.lineWidth = 1.4;
  ctx.setLineDash([6, 5]);
  trace(ctx, [view.offset(place, heading, radius * 0.25), view.offset(place, heading, radius)]);
  ctx.stroke();
  ctx.setLineDash([]);
  const tip = view.offset(place, heading, radius);
  trace(ctx, [tip, view.offset(tip, heading + 0.5, 16), view.offset(tip, heading - 0.5, 16)], true);
  ctx.fill();
}

/** Draw the variable range marker: a ring at a range and a line at a bearing. */
export function drawVrm(ctx, view, place, { range, bearing }, reach, colours) {
  ctx.strokeStyle = colours.text;
  ctx.lineWidth = 1.3;
  ctx.setLineDash([3, 4]);
  circle(ctx, place, range * view.scale);
  ctx.stroke();
  trace(ctx, [place, view.offset(place, bearing, reach)]);
  ctx.stroke();
  ctx.setLineDash([]);
  const cross = view.offset(place, bearing, range * view.scale);
  circle(ctx, cross, 4);
  ctx.stroke();
}
