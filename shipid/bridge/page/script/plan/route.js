// The planned route: legs, the planned line with its turns, cross-track limits, waypoints, the wheel-over line at 90 degrees to the leg.

import { clock } from "../figures.js";
import { trace } from "./projection.js";

const MITRE = 4;
/** Half the length of the wheel-over line in m where the route states no limits: a tenth of a mile. */
const SIDE = 185.2;

function unit(a, b) {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const size = Math.hypot(dx, dy);
  return size > 0 ? { x: dx / size, y: dy / size, size } : null;
}

// Where two offset legs meet: at their crossing, or, where that is far away or they are parallel, at both their ends.
function corner(point, before, after, a, b) {
  const end = (leg, offset) => ({ x: point.x - leg.y * offset, y: point.y + leg.x * offset });
  const [p, q] = [end(before, a), end(after, b)];
  const cross = before.x * after.y - before.y * after.x;
  if (Math.abs(cross) < 1e-3) return [p, q];
  const t = ((q.x - p.x) * after.y - (q.y - p.y) * after.x) / cross;
  if (Math.abs(t) > MITRE * Math.max(Math.abs(a), Math.abs(b))) return [p, q];
  return [{ x: p.x + before.x * t, y: p.y + before.y * t }];
}

/** Return the limit of a route to one side as a line: the limits are those of the waypoint at each leg's end; starboard is 1. */
export function limitLine(waypoints, side) {
  const legs = [];
  for (let i = 1; i < waypoints.length; i++) {
    const along = unit(waypoints[i - 1], waypoints[i]);
    const limit = side > 0 ? waypoints[i].xtd_starboard : waypoints[i].xtd_port;
    if (along && limit > 0) legs.push({ along, offset: side * limit, from: waypoints[i - 1], to: waypoints[i] });
  }
  const out = [];
  legs.forEach((leg, i) => {
    const { along, offset } = leg;
    if (i === 0) out.push({ x: leg.from.x - along.y * offset, y: leg.from.y + along.x * offset });
    const next = legs[i + 1];
    if (next) out.push(...corner(leg.to, along, next.along, offset, next.offset));
    else out.push({ x: leg.to.x - along.y * offset, y: leg.to.y + along.x * offset });
  });
  return out;
}

/** Draw the route; leg k runs from waypoint k to waypoint k + 1. */
export function drawRoute(ctx, view, route, colours) {
  const at = ({ x, y }) => view.point(x, y);
  ctx.strokeStyle = colours.route;
  ctx.lineJoin = "round";
  for (const side of [-1, 1]) {
    trace(ctx, limitLine(route.waypoints, side).map(at));
    ctx.setLineDash([2, 5]);
    ctx.lineWidth = 1.2;
    ctx.stroke();
  }
  trace(ctx, route.waypoints.map(at));
  ctx.setLineDash([10, 5]);
  ctx.lineWidth = 1;
  ctx.stroke();
  if (route.line?.length) {
    trace(ctx, route.line.map(([x, y]) => view.point(x, y)));
    ctx.setLineDash([]);
    ctx.lineWidth = 1.6;
    ctx.stroke();
  }
  ctx.setLineDash([]);
  ctx.lineWidth = 1.6;
  route.waypoints.forEach((waypoint, i) => {
    const [x, y] = at(waypoint);
    ctx.beginPath();
    ctx.arc(x, y, i === route.leg + 1 ? 7 : 5, 0, 2 * Math.PI);
    ctx.fillStyle = colours.sea;
    ctx.fill();
    ctx.stroke();
  });
  drawWheelOver(ctx, view, route, colours);
}

// The ends of the wheel-over line, in the world: across the leg, as far as its limits.
export function wheelOverLine(route) {
  const [from, to] = [route.waypoints[route.leg], route.waypoints[route.leg + 1]];
  const along = from && to ? unit(from, to) : null;
  const { wheel_over: wheel } = route;
  if (!along || !wheel || !Number.isFinite(wheel.x) || !Number.isFinite(wheel.y)) return null;
  const ends = [-(to.xtd_port ?? SIDE), to.xtd_starboard ?? SIDE];
  return ends.map((side) => ({ x: wheel.x - along.y * side, y: wheel.y + along.x * side }));
}

function drawWheelOver(ctx, view, route, colours) {
  const ends = wheelOverLine(route);
  if (!ends) return;
  trace(ctx, ends.map(({ x, y }) => view.point(x, y)));
  ctx.setLineDash([]);
  ctx.lineWidth = 3;
  ctx.stroke();
}

/** Write the names of the waypoints and the time to the wheel-over. */
export function labelRoute(view, route, colours, labels) {
  const ends = wheelOverLine(route);
  if (ends) {
    const seconds = route.wheel_over.seconds;
    labels.write(`wheel-over ${clock(seconds)}`, view.point(ends[1].x, ends[1].y), colours.route, { bold: true, away: 6 });
  }
  route.waypoints.forEach((waypoint, i) => {
    labels.write(waypoint.name || `WP ${i}`, view.point(waypoint.x, waypoint.y), colours.route, { bold: i === route.leg + 1, away: 10 });
  });
}
