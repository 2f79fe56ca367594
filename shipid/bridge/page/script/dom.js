// The few steps by which every module builds its part of the page.

const SVG = "http://www.w3.org/2000/svg";

function made(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    node.setAttribute(name, value === true ? "" : String(value));
  }
  node.append(...children);
  return node;
}

/** Return an HTML element with its attributes and children. */
export const el = (name, attributes = {}, ...children) => made(document.createElement(name), attributes, children);

/** Return an SVG element with its attributes and children. */
export const svg = (name, attributes = {}, ...children) => made(document.createElementNS(SVG, name), attributes, children);

/** Write a text only where it changed: a tick comes ten times a second and most of it is as it was. */
export function put(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Set an attribute only where it changed; null takes it away. */
export function mark(node, name, value) {
  if (value === null) {
    if (node.hasAttribute(name)) node.removeAttribute(name);
  } else if (node.getAttribute(name) !== String(value)) {
    node.setAttribute(name, String(value));
  }
}

/** Return a row of keys of which one is chosen, and a function that shows the choice. Arrow keys move through it, as in a radio group. */
export function segments(holder, choices, choose) {
  const keys = choices.map(({ value, text, name }) => {
    const key = el("button", { type: "button", role: "radio", "aria-checked": "false", "aria-label": name ?? null }, text);
    key.addEventListener("click", () => choose(value));
    return { value, key };
  });
  holder.replaceChildren(...keys.map(({ key }) => key));
  holder.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    const at = keys.findIndex(({ key }) => key === document.activeElement);
    if (!step || at < 0) return;
    event.preventDefault();
    event.stopPropagation();
    const usable = keys.filter(({ key }) => !key.disabled);
    const next = usable[(usable.indexOf(keys[at]) + step + usable.length) % usable.length];
    next.key.focus();
    choose(next.value);
  });
  const show = (chosen) => {
    const any = keys.some(({ value }) => value === chosen);
    keys.forEach(({ value, key }, i) => {
      mark(key, "aria-checked", value === chosen);
      key.tabIndex = value === chosen || (!any && i === 0) ? 0 : -1;
    });
  };
  const allow = (values) => keys.forEach(({ value, key }) => { key.disabled = !values.includes(value); });
  return { show, allow };
}
