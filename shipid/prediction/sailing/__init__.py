"""Simulated ships under their autopilots: a voyage as a trial, and a ship that sails on step by step."""
