"""Logs as they are written: one line in, the samples it completes out, read as the whole log would be."""
