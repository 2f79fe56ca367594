"""Manoeuvres by name, simulated in open and closed loop."""
