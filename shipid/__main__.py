"""``python -m shipid``: the command line."""

from shipid.cli import entry

entry()
