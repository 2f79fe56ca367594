"""Readings of one signal that several rooms share: smoothed values, crossings and extremes, and the plates of a rudder."""
