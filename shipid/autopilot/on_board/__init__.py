"""The autopilot on board: model reference, other modes, the filter in the loop."""
