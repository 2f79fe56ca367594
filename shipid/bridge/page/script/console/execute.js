// EXECUTE, under its lid: the first press arms, the second executes; whatever changes in between closes the lid again.

import { mark, put } from "../dom.js";
import { inWords } from "./settings.js";

/** How long in ms the lid stays open. */
const OPEN = 10000;

/** Return the deeds of the two keys and a function that shows them. */
export function createExecute(model, settings, send, keys) {
  const { execute, cancel, region } = keys;
  let armed = null;

  const signature = () => JSON.stringify(settings.trial());

  function press() {
    if (execute.disabled) return;
    if (armed && armed.signature === signature()) {
      armed = null;
      if (send({ command: "execute" })) put(region, `Executed: ${inWords(settings.trial())}.`);
    } else {
      armed = { signature: signature(), at: performance.now() };
      put(region, `Armed: ${inWords(settings.trial())}. Press again to execute.`);
    }
    show();
  }

  function back() {
    armed = null;
    settings.drop();
    if (send({ command: "cancel" })) put(region, "Cancelled: the trial is what is executed.");
    show();
  }

  function show() {
    execute.disabled = cancel.disabled = !model.link.connected;
    if (armed && (execute.disabled || armed.signature !== signature() || performance.now() - armed.at > OPEN)) armed = null;
    mark(execute, "aria-pressed", armed ? "true" : "false");
    put(execute, armed ? "ARMED · press again" : "EXECUTE");
  }

  execute.addEventListener("click", press);
  cancel.addEventListener("click", back);
  return { press, back, show };
}
