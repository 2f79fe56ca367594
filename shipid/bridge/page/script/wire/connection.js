// The WebSocket: it connects, hands frames to the model, and tries again for as long as the page is open.

const WAITS = [0.5, 1, 2, 3, 5];
/** Without a frame for so many seconds the picture is called old: the server sends ten a second. */
const SILENT = 1.5;

/** Keep a connection to the page's own host; report calls `told` whenever it is made, lost or silent. */
export function connect(model, told) {
  const address = new URL(`ws${location.search}`, location.href);
  address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
  const { link } = model;
  let socket = null;
  let attempts = 0;

  function open() {
    socket = new WebSocket(address);
    socket.addEventListener("message", (event) => {
      let frame;
      try {
        frame = JSON.parse(event.data);
      } catch {
        link.unreadable = true;
        told();
        return;
      }
      attempts = 0;
      if (!link.connected || link.unreadable) {
        link.connected = link.everConnected = true;
        link.unreadable = false;
        told();
      }
      model.take(frame);
    });
    socket.addEventListener("close", () => {
      link.connected = false;
      told();
      setTimeout(open, WAITS[Math.min(attempts++, WAITS.length - 1)] * 1000);
    });
  }

  // The one timer of the page: only a clock notices that nothing comes.
  setInterval(() => {
    if (link.connected && model.silence() > SILENT) {
      link.connected = false;
      told();
      // A connection that is open and dumb is given up, so that a new one can be made.
      if (model.silence() > 4 * SILENT) socket.close();
    } else if (!link.connected) {
      told();
    }
  }, 500);

  open();
  return {
    /** Send a command; false where there is no connection to send it by. */
    send(command) {
      if (socket.readyState !== WebSocket.OPEN || !link.connected) return false;
      socket.send(JSON.stringify(command));
      return true;
    },
  };
}
