// A number that is typed: it shows what holds until it is edited, says what is wrong with it, and is given by Enter or on leaving.

import { el, mark, put } from "../dom.js";
import { typed } from "../figures.js";

/**
 * Return a field for one number.
 *
 * `give` takes the number; `fits` says whether it is one that can be meant; `fail` is told in words where it is not, and with an
 * empty text once it is mended.
 */
export function createField({ label, unit = "", give, fits = () => true, hint = "", fail = () => {}, steps = null }) {
  const input = el("input", { type: "text", inputmode: "decimal", autocomplete: "off", spellcheck: "false", "aria-label": label });
  const after = el("span", { class: "unit" }, unit);
  const box = el("div", { class: "field" }, input, after);
  const about = { fits, hint };
  let shown = "";

  function restore() {
    input.value = shown;
    wrong(false);
  }

  function wrong(is) {
    mark(input, "aria-invalid", is ? "true" : null);
    fail(is ? about.hint : "");
  }

  /** Give the number; true where there was one to give. */
  function commit() {
    if (input.value === shown) return false;
    const number = typed(input.value);
    if (number === null || !about.fits(number)) {
      wrong(true);
      return true;
    }
    wrong(false);
    shown = input.value;
    give(number);
    return true;
  }

  input.addEventListener("focus", () => input.select());
  input.addEventListener("change", commit);
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && commit()) event.stopPropagation();
    if (event.key === "Escape" && input.value !== shown) {
      restore();
      event.stopPropagation();
    }
    if (steps && (event.key === "ArrowUp" || event.key === "ArrowDown")) {
      event.preventDefault();
      steps(event.key === "ArrowUp" ? 1 : -1);
    }
  });

  return {
    box, input,
    /** Show a text, unless the navigator is typing another. */
    show(text) {
      if (text === shown) return;
      const editing = document.activeElement === input && input.value !== shown;
      shown = text;
      if (!editing && input.getAttribute("aria-invalid") !== "true") input.value = text;
      if (document.activeElement === input && !editing) input.select();
    },
    /** Change what the field is for. */
    become(next) {
      mark(input, "aria-label", next.label);
      put(after, next.unit);
      Object.assign(about, next);
      restore();
    },
    use(possible) {
      input.disabled = !possible;
    },
  };
}
