"""A whole record through a filter: run, smoother, likelihood, observability."""
