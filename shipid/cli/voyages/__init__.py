"""Commands for a ship that is known: tune an autopilot, predict, the bridge."""
