"""Choosing a structure: candidates with what was measured in them, tried side by side, scored and weighed."""
