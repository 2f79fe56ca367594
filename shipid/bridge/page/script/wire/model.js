// What the page knows: the newest snapshot with every tick since, and how old that is.

const PAST = 6000;

/** A model that merges what the server sends and tells everyone who watches. */
export function createModel() {
  const state = {};
  const past = { t: [], x: [], y: [] };
  const watchers = [];
  const link = { connected: false, everConnected: false, heard: null, replies: [] };

  function tell(changed) {
    for (const watch of watchers) watch(state, changed);
  }

  function addPast(points) {
    for (const [t, x, y] of points) {
      past.t.push(t); past.x.push(x); past.y.push(y);
    }
    // A day's sailing stays drawable: where it grows long, every second point goes.
    if (past.t.length > PAST) for (const name of ["t", "x", "y"]) past[name] = past[name].filter((_, i) => i % 2 === 0);
  }

  /** Take a frame of the server: a snapshot replaces everything, a tick what it names. */
  function take(frame) {
    link.heard = performance.now();
    if (frame.kind === "snapshot") {
      for (const key of Object.keys(state)) delete state[key];
      for (const name of ["t", "x", "y"]) past[name] = [];
      const { kind, past: before, ...rest } = frame;
      Object.assign(state, rest);
      if (before) addPast(before.t.map((t, i) => [t, before.x[i], before.y[i]]));
      tell(new Set(Object.keys(state)));
    } else if (frame.kind === "tick") {
      const { kind, past_add: added, ...rest } = frame;
      Object.assign(state, rest);
      if (added) addPast(added);
      tell(new Set(Object.keys(rest)));
    } else if (frame.kind === "reply") {
      link.reply?.(frame);
    }
  }

  return {
    state, past, link, take, tell,
    /** Call a function with the state and the set of changed keys, after every frame. */
    watch: (watch) => watchers.push(watch),
    /** Seconds since the server was last heard, 0 where it never was. */
    silence: () => (link.heard === null ? 0 : (performance.now() - link.heard) / 1000),
  };
}
