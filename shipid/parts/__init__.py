"""Components that every ship joins: planar motion, steering machine, current, wind, waves, sensors, helm."""
