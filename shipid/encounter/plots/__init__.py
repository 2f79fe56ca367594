"""Plots of radar, lidar and AIS: what they are, and reading them from logs."""
