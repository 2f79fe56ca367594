"""Manoeuvring criteria of a model as a page, or as a section of one."""
