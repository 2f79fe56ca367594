"""Examinations of what the ship did: heading, rate of turn, speeds and track against one another."""
