"""Where the bridge's samples come from: a simulated ship, a trial, NMEA 0183 or Signal K."""
