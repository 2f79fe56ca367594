"""Autopilots: gain-scheduled design from the declaration, its judgement, and the model reference."""
