// The palette of the style sheet, as the canvas needs it.

const NAMES = ["sea", "shoal", "shallow", "land", "ring", "text", "soft", "own", "trial", "executed", "route", "past", "target", "panel", "edge"];

/** Read the colours of the palette that holds. */
export function readColours() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}
