// Own ship to scale with her heading line and her vector over the ground, and the other ships.

import { degrees, known, knots } from "../figures.js";
import { trace } from "./projection.js";

// Half of a hull from the bow to the stern: along in lengths from amidships, aside in half beams.
const LINES = [[0.5, 0], [0.42, 0.45], [0.3, 0.85], [0.15, 1], [-0.4, 1], [-0.5, 0.8]];
/** Beam over length where the beam is not known. */
const SLENDER = 1 / 7;

/** The outline of a ship in pixels. */
export function hull(view, { x, y, psi }, { length, beam }) {
  const half = (beam ?? length * SLENDER) / 2;
  const [cos, sin] = [Math.cos(psi), Math.sin(psi)];
  const at = (along, aside) => view.point(x + along * length * cos - aside * half * sin, y + along * length * sin + aside * half * cos);
  return [...LINES.map(([a, b]) => at(a, b)), ...LINES.slice(1).reverse().map(([a, b]) => at(a, -b))];
}

/** Draw own ship; where she is too small to be seen to scale, two circles show where she is. */
export function drawOwn(ctx, view, own, ship, colours, { line, reach }) {
  const place = view.point(own.x, own.y);
  ctx.strokeStyle = colours.own;
  ctx.lineWidth = 2;
  ctx.setLineDash([]);
  if (known(own.psi) && line) {
    trace(ctx, [place, view.offset(place, own.psi, reach)]);
    ctx.lineWidth = 1.2;
    ctx.stroke();
  }
  const length = ship.length * view.scale;
  if (known(own.psi) && length >= 6) {
    trace(ctx, hull(view, own, ship), true);
    ctx.fillStyle = colours.sea;
    ctx.fill();
    ctx.lineWidth = 2;
    ctx.setLineDash(known(ship.beam) ? [] : [4, 3]);
    ctx.stroke();
    ctx.setLineDash([]);
  }
  if (!known(own.psi) || length < 14) {
    for (const radius of [3.5, 8]) {
      ctx.beginPath();
      ctx.arc(place[0], place[1], radius, 0, 2 * Math.PI);
      ctx.lineWidth = 1.5;
      ctx.stroke();
    }
  }
}

/** Draw the vector over the ground: where the ship would be after `seconds` if nothing changed; two heads say "over the ground". */
export function drawVector(ctx, view, own, seconds, colour) {
  if (!known(own.sog) || !known(own.cog)) return;
  const start = view.point(own.x, own.y);
  const length = own.sog * seconds * view.scale;
  if (length < 4) return;
  const end = view.offset(start, own.cog, length);
  ctx.strokeStyle = colour;
  ctx.lineWidth = 1.6;
  trace(ctx, [start, end]);
  ctx.setLineDash([12, 4]);
  ctx.stroke();
  ctx.setLineDash([]);
  for (const back of [0, 8]) {
    const tip = view.offset(end, own.cog, -back);
    trace(ctx, [view.offset(tip, own.cog + Math.PI * 0.83, 9), tip, view.offset(tip, own.cog - Math.PI * 0.83, 9)]);
    ctx.stroke();
  }
}

/** Draw another ship: a triangle along her course, her vector, her name. */
export function drawTarget(ctx, view, target, seconds, colours, labels) {
  if (!known(target.x) || !known(target.y)) return;
  const place = view.point(target.x, target.y);
  const course = target.course ?? 0;
  const old = known(target.age) && target.age > 60;
  ctx.strokeStyle = colours.target;
  ctx.lineWidth = 1.8;
  ctx.setLineDash(old ? [3, 3] : []);
  trace(ctx, [view.offset(place, course, 11), view.offset(place, course + 2.5, 8), view.offset(place, course - 2.5, 8)], true);
  ctx.stroke();
  ctx.setLineDash([]);
  if (known(target.speed) && known(target.course)) {
    ctx.lineWidth = 1;
    ctx.setLineDash([5, 4]);
    trace(ctx, [view.offset(place, course, 11), view.offset(place, course, Math.max(11, target.speed * seconds * view.scale))]);
    ctx.stroke();
    ctx.setLineDash([]);
  }
  const data = known(target.speed) && known(target.course) ? ` ${degrees(target.course).slice(0, 3)}° ${knots(target.speed)} kn` : "";
  labels.write(`${target.name ?? target.id}${data}`, place, colours.target, { away: 12 });
}
