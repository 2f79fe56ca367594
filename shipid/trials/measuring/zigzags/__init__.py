"""Zig-zags: executes, swings, initial turning."""
