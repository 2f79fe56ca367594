"""The record of the rudder, and the executes that are read from it."""
