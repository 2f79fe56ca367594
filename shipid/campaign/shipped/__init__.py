"""Campaigns that come with the installation: one file each, found by name."""
