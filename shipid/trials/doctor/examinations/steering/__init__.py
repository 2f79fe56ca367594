"""Examinations of the rudder and of what the ship answers to it."""
