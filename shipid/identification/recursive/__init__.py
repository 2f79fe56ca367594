"""Recursive identification: one family of estimators that takes a record sample by sample, under one interface."""
