// From metres north and east to pixels: the ship stands still on the screen, the world moves and turns.

/**
 * Return the projection of a view.
 *
 * `place` is the world's point under the ship, `at` its pixel, `scale` in pixels a metre, `up` the direction in rad that points up.
 */
export function projection({ place, at, scale, up }) {
  const [cos, sin] = [Math.cos(up) * scale, Math.sin(up) * scale];
  const point = (x, y) => {
    const [north, east] = [x - place.x, y - place.y];
    return [at.x + east * cos - north * sin, at.y - north * cos - east * sin];
  };
  // The same as a matrix of the canvas, for paths drawn in (east, north).
  const matrix = new DOMMatrix([cos, -sin, -sin, -cos, at.x - place.y * cos + place.x * sin, at.y + place.x * cos + place.y * sin]);
  return {
    point, matrix, scale, up, at, place,
    /** The world's point under a pixel. */
    world(px, py) {
      const [dx, dy] = [(px - at.x) / scale, (at.y - py) / scale];
      const [c, s] = [Math.cos(up), Math.sin(up)];
      return { x: place.x + dy * c - dx * s, y: place.y + dx * c + dy * s };
    },
    /** The pixel at a distance in pixels and a true direction from a pixel. */
    offset([x, y], angle, pixels) {
      return [x + pixels * Math.sin(angle - up), y - pixels * Math.cos(angle - up)];
    },
  };
}

/** Points as pixels, without those that are not known. */
export function pixels(view, xs, ys) {
  const out = [];
  for (let i = 0; i < xs.length; i++) {
    if (Number.isFinite(xs[i]) && Number.isFinite(ys[i])) out.push(view.point(xs[i], ys[i]));
  }
  return out;
}

/** Draw a line through pixels. */
export function trace(ctx, points, closed = false) {
  ctx.beginPath();
  points.forEach(([x, y], i) => (i ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
  if (closed) ctx.closePath();
}
