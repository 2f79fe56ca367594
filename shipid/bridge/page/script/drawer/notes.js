// What was found out when the route and the chart were read: a limit that was not understood is not heeded.

import { el } from "../dom.js";

/** Return the part of the drawer that lists the notes. */
export function createNotes() {
  const list = el("ul", { class: "notes" });
  const section = el("section", { hidden: "" }, el("h2", {}, "Route and chart"), list);
  let shown = "";
  return {
    section,
    show({ notes = [] }) {
      const text = notes.join("\n");
      if (text === shown) return;
      shown = text;
      section.hidden = notes.length === 0;
      list.replaceChildren(...notes.map((note) => el("li", {}, note)));
    },
  };
}
