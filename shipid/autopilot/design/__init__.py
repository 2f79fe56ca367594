"""The design of an autopilot: plant, gains, schedule, control law."""
