// The chart, below everything: depth areas, land, contours, buoys. Its paths are made once, in metres.

const BUOYS = 600;

function ring(path, points) {
  points.forEach(([x, y], i) => (i ? path.lineTo(y, x) : path.moveTo(y, x)));
  path.closePath();
}

function line(path, points) {
  points.forEach(([x, y], i) => (i ? path.lineTo(y, x) : path.moveTo(y, x)));
}

/** Make the paths of a chart; null where there is no chart. */
export function prepare(chart) {
  if (!chart) return null;
  const land = new Path2D();
  for (const rings of chart.land ?? []) rings.forEach((points) => ring(land, points));
  const depths = [...(chart.depth_areas ?? [])].sort((a, b) => (b.min ?? 0) - (a.min ?? 0)).map(({ min, max, rings }) => {
    const path = new Path2D();
    rings.forEach((points) => ring(path, points));
    return { min, max, path };
  });
  const contours = new Path2D();
  for (const { line: points } of chart.contours ?? []) line(contours, points);
  const coast = new Path2D();
  for (const points of chart.coast ?? []) line(coast, points);
  const marks = (chart.contours ?? []).filter(({ depth, line: points }) => depth !== null && points.length > 1);
  return { land, depths, contours, coast, marks, buoys: chart.buoys ?? [], name: chart.name ?? "" };
}

/** Draw the areas and lines of a chart. */
export function drawChart(ctx, view, chart, colours, ratio) {
  if (!chart) return;
  const world = new DOMMatrix([ratio, 0, 0, ratio, 0, 0]).multiply(view.matrix);
  ctx.save();
  ctx.setTransform(world);
  // Deep water is the ground of the plan view; less than 10 m and less than 30 m stand out.
  for (const { min, max, path } of chart.depths) {
    const most = max ?? Infinity;
    if ((min ?? 0) >= 30) ctx.fillStyle = colours.sea;
    else ctx.fillStyle = most <= 10 ? colours.shoal : colours.shallow;
    ctx.fill(path, "evenodd");
  }
  ctx.fillStyle = colours.land;
  ctx.fill(chart.land, "evenodd");
  ctx.restore();

  const onScreen = (path) => {
    const moved = new Path2D();
    moved.addPath(path, view.matrix);
    return moved;
  };
  ctx.setLineDash([]);
  ctx.lineWidth = 0.8;
  ctx.strokeStyle = colours.ring;
  ctx.globalAlpha = 0.75;
  ctx.stroke(onScreen(chart.contours));
  ctx.globalAlpha = 1;
  ctx.lineWidth = 1.4;
  ctx.strokeStyle = colours.soft;
  ctx.stroke(onScreen(chart.land));
  ctx.stroke(onScreen(chart.coast));
}

// Shapes tell the kinds apart, as topmarks do: a can to port, a cone to starboard, a diamond, two balls, a ball, a cross.
const SHAPES = {
  port: (ctx, x, y) => ctx.rect(x - 4, y - 9, 8, 9),
  starboard: (ctx, x, y) => { ctx.moveTo(x, y - 10); ctx.lineTo(x + 5, y); ctx.lineTo(x - 5, y); ctx.closePath(); },
  cardinal: (ctx, x, y) => { ctx.moveTo(x, y - 10); ctx.lineTo(x + 5, y - 5); ctx.lineTo(x, y); ctx.lineTo(x - 5, y - 5); ctx.closePath(); },
  isolated: (ctx, x, y) => { ctx.arc(x, y - 3, 3, 0, 7); ctx.moveTo(x + 3, y - 9); ctx.arc(x, y - 9, 3, 0, 7); },
  safe: (ctx, x, y) => ctx.arc(x, y - 5, 5, 0, 7),
  special: (ctx, x, y) => { ctx.moveTo(x - 4, y - 9); ctx.lineTo(x + 4, y - 1); ctx.moveTo(x + 4, y - 9); ctx.lineTo(x - 4, y - 1); },
};

// The topmark of a cardinal mark: two cones, each pointing up (1) or down (-1).
const QUARTERS = { north: [1, 1], south: [-1, -1], east: [1, -1], west: [-1, 1] };

function cones(ctx, x, y, [upper, lower]) {
  for (const [way, base] of [[upper, y - 7], [lower, y]]) {
    ctx.moveTo(x - 4, way > 0 ? base : base - 6);
    ctx.lineTo(x + 4, way > 0 ? base : base - 6);
    ctx.lineTo(x, way > 0 ? base - 6 : base);
    ctx.closePath();
  }
}

// Colours are written, as on a paper chart, because red and green mean port and starboard on this page.
const LETTERS = { red: "R", green: "G", yellow: "Y", black: "B", white: "W", orange: "Or", amber: "Y", blue: "Bu" };
const lettered = (colours) => (colours ?? []).map((name) => LETTERS[name] ?? "").join("");

/** Draw buoys and the depths of contours, those in sight. */
export function drawBuoys(ctx, view, chart, colours, labels, size) {
  if (!chart) return;
  let count = 0;
  for (const { x, y, name, kind, quarter, colour, structure } of chart.buoys) {
    const [px, py] = view.point(x, y);
    if (px < -20 || py < -20 || px > size.width + 20 || py > size.height + 20 || ++count > BUOYS) continue;
    ctx.beginPath();
    if (kind === "cardinal" && quarter in QUARTERS) cones(ctx, px, py - 2, QUARTERS[quarter]);
    else (SHAPES[kind] ?? SHAPES.safe)(ctx, px, py);
    ctx.setLineDash([]);
    ctx.lineWidth = 1.6;
    ctx.strokeStyle = colours.text;
    ctx.fillStyle = colours.panel;
    ctx.fill();
    ctx.stroke();
    ctx.beginPath();
    if (structure === "beacon") ctx.rect(px - 2, py - 1, 4, 4);
    else ctx.arc(px, py, 1.8, 0, 7);
    ctx.stroke();
    const text = [name, lettered(colour)].filter(Boolean).join(" ");
    if (text) labels.write(text, [px, py - 4], colours.soft, { away: 9 });
  }
  for (const { depth, line: points } of chart.marks) {
    const [x, y] = points[Math.floor(points.length / 2)];
    labels.write(String(depth), view.point(x, y), colours.soft, { size: 11, centred: true });
  }
}
