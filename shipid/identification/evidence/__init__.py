"""Rudder biases as random effects: how far the biases of trials are spread, estimated with the coefficients."""
