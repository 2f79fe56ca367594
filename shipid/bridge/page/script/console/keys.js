// The keyboard: what a navigator does most goes without a pointer, and without leaving the plan view with the eyes.

/** Whether a key pressed here belongs to the element that has the focus. */
function taken(target, key) {
  if (target.closest("input, select, textarea")) return key !== "Enter" && key !== "Escape";
  if (key === "Enter" || key === " ") return Boolean(target.closest("button, a, summary"));
  return Boolean(target.closest('[role="radiogroup"]')) && key.startsWith("Arrow");
}

/** Connect the keyboard. `letters` says whether keys without a name (n, h, +, [ ...) are used. */
export function createKeys({ settings, console, plan, letters }) {
  const turns = { ArrowRight: [1, false], ArrowLeft: [-1, false], ArrowUp: [1, true], ArrowDown: [-1, true] };
  const named = {
    Enter: () => console.execute(),
    Escape: () => console.cancel(),
  };
  const signs = {
    "[": () => settings.turnLimit(-1),
    "]": () => settings.turnLimit(1),
    "+": () => plan.changeRange(1),
    "=": () => plan.changeRange(1),
    "-": () => plan.changeRange(-1),
    n: () => plan.setOrientation("north"),
    h: () => plan.setOrientation("head"),
    c: () => plan.setOrientation("course"),
    v: () => plan.toggle("vrm"),
  };

  // A key of the page that was pressed with the pointer gives the keyboard back: otherwise Enter would press it again instead of
  // executing, and an arrow would move through a row of keys instead of turning the heading.
  document.addEventListener("click", (event) => {
    if (event.detail > 0) event.target.closest("button")?.blur();
  });

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || taken(event.target, event.key)) return;
    const turn = turns[event.key];
    if (turn) {
      event.preventDefault();
      settings.turn(turn[0], turn[1] || event.shiftKey);
      return;
    }
    // Holding a key down must not arm and execute in one breath.
    const deed = named[event.key] ?? (letters() ? signs[event.key.toLowerCase()] : null);
    if (!deed || (event.repeat && event.key in named)) return;
    event.preventDefault();
    deed();
  });
}

/** What the keys do, for the list in the drawer. */
export const KEYS = [
  [["←", "→"], "trial heading (rudder, rate) 1 to port, to starboard"],
  [["↓", "↑"], "the same by 5"],
  [["[", "]"], "trial rudder limit 1° less, more"],
  [["Enter", "Enter"], "arm, execute"],
  [["Esc"], "cancel: the trial is what is executed"],
  [["+", "−"], "range longer, shorter"],
  [["n", "h", "c"], "north up, head up, course up"],
  [["v"], "variable range marker on, off"],
];
