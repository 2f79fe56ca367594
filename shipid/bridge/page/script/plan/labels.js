// Words on the plan view: each finds a free place beside its point, or is left out. What is asked first goes first, and all are painted
// last, so that nothing that is drawn lies over a word.

const SIZE = 12;
const PLACES = [[1, -1], [1, 1], [-1, -1], [-1, 1], [0, -1.6], [0, 1.6]];

/** Return a sheet of labels for one drawing of the canvas. `reserved` are rectangles [x, y, width, height] that stay free. */
export function createLabels(ctx, width, height, halo, reserved) {
  const taken = [...reserved];
  const words = [];
  const free = ([x, y, w, h]) => x >= 2 && y >= 2 && x + w <= width - 2 && y + h <= height - 2
    && !taken.some(([a, b, c, d]) => x < a + c && a < x + w && y < b + d && b < y + h);

  /** Write a text beside a point; `away` in pixels from it, `must` where it is written even over another; false where there was no room. */
  function write(text, [px, py], colour, { away = 8, bold = false, must = false, size = SIZE, centred = false } = {}) {
    ctx.font = `${bold ? "700" : "500"} ${size}px "Noto Sans", "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif`;
    const w = ctx.measureText(text).width;
    const box = ([sx, sy]) => {
      const x = sx > 0 ? px + away : sx < 0 ? px - away - w : px - w / 2;
      return [x - 2, py + sy * away * (sx ? 0.6 : 1) - size / 2 - 1, w + 4, size + 3];
    };
    const boxes = centred ? [[px - w / 2 - 2, py - size / 2 - 1, w + 4, size + 3]] : PLACES.map(box);
    const found = boxes.find(free) ?? (must ? boxes[0] : null);
    if (!found) return false;
    taken.push(found);
    words.push({ text, font: ctx.font, colour, x: found[0] + 2, y: found[1] + found[3] / 2 });
    return true;
  }

  /** Write a text beside a line, `away` pixels along a direction of the screen (0 is up), or on the other side of it. */
  function beside(text, [px, py], angle, colour, away = 15) {
    for (const way of [1, -1]) {
      const point = [px + way * away * Math.sin(angle), py - way * away * Math.cos(angle)];
      if (write(text, point, colour, { centred: true, size: 11 })) return;
    }
  }

  /** Keep a square around a point free of words. */
  const keep = ([x, y], half) => taken.push([x - half, y - half, 2 * half, 2 * half]);

  /** Paint the words, over all that has been drawn. */
  function paint() {
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    ctx.lineJoin = "round";
    ctx.setLineDash([]);
    ctx.lineWidth = 3.5;
    ctx.strokeStyle = halo;
    for (const { text, font, colour, x, y } of words) {
      ctx.font = font;
      ctx.fillStyle = colour;
      ctx.strokeText(text, x, y);
      ctx.fillText(text, x, y);
    }
  }

  return { write, beside, keep, paint };
}
