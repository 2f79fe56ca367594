"""Examinations of the table itself: rows, clock, missing samples, wild and frozen values, sampling."""
