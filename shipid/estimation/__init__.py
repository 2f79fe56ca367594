"""Estimation: Kalman filters and smoothers generated from a declared model."""
