// The ship's state for a screen reader: once in ten seconds, from the messages.

import { put } from "../dom.js";
import { aside, clock, degrees, known, knots, perMinute, plain } from "../figures.js";

const EVERY = 10000;

const side = (value) => (value < 0 ? "to port" : "to starboard");

/** Say the ship's state in one sentence. */
export function sentence({ own, route, time }) {
  if (!own) return "";
  const parts = [];
  if (time?.state && time.state !== "running") parts.push(`Source ${time.state}`);
  parts.push(known(own.psi) ? `Heading ${degrees(own.psi)} degrees` : "Heading not known");
  if (known(own.cog)) parts.push(`course over ground ${degrees(own.cog)}`);
  if (known(own.sog)) parts.push(`speed over ground ${knots(own.sog)} knots`);
  if (known(own.r)) parts.push(`turning ${perMinute(Math.abs(own.r))} degrees a minute ${side(own.r)}`);
  if (known(own.delta)) parts.push(`rudder ${plain(Math.abs(own.delta) * 180 / Math.PI, 0)} ${side(own.delta)}`);
  if (known(route?.wheel_over?.seconds)) parts.push(`wheel-over in ${clock(route.wheel_over.seconds)}`);
  if (known(route?.off_track)) parts.push(`off track ${aside(Math.abs(route.off_track)).replace(/ S$/, "")} ${side(route.off_track)}`);
  return `${parts.join(", ")}.`;
}

/** Return a function that speaks at most once in ten seconds. */
export function createAnnouncer() {
  const region = document.getElementById("state-region");
  const plan = document.getElementById("plan");
  let last = -Infinity;
  return (state) => {
    if (performance.now() - last < EVERY) return;
    last = performance.now();
    const text = sentence(state);
    put(region, text);
    plan.setAttribute("aria-label", `Plan view. ${text}`);
  };
}
