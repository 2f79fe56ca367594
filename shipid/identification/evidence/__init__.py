"""The evidence of trials: how far their rudder biases are spread, estimated with the coefficients, and whether they show anything at all."""
