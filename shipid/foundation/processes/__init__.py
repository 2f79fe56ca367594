"""Processes: work in a process of its own, and signals that end this one."""
