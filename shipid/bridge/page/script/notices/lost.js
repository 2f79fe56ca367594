// Whether the server is heard, in words: a picture that is old must not look like one that is new.

import { mark, put } from "../dom.js";
import { age } from "../figures.js";

/** Return a function that shows the state of the connection. */
export function createLost(model) {
  const banner = document.getElementById("lost");
  const region = document.getElementById("alarm-region");
  let was = true;
  return () => {
    const { link } = model;
    banner.hidden = link.connected && !link.unreadable;
    document.body.classList.toggle("old-picture", !link.connected);
    mark(document.body, "data-connected", link.connected ? "yes" : "no");
    if (link.unreadable) put(banner, "The server sent something that cannot be read: what is shown may be old.");
    else if (!link.everConnected) put(banner, "No connection to the server yet: trying again.");
    else if (!link.connected) put(banner, `Connection lost: everything shown is ${age(model.silence())} old. Trying again.`);
    if (was && !link.connected && link.everConnected) put(region, "Connection to the server lost.");
    if (!was && link.connected) put(region, "Connected.");
    was = link.connected;
  };
}
