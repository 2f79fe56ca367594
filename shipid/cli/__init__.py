"""The command line: thin, and it imports what a command needs when the command runs.

Results go to stdout (``--json`` for machines), progress and messages to stderr. Exit codes: `shipid.foundation.exit_codes`.
What stands in `shipid.cli.frame.group` is loaded when it is first used, so that a command can be stopped from its first line on.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any

from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.processes.stopping import Terminated, end_now, ignore_from_now, watched


def __getattr__(name: str) -> Any:  # noqa: ANN401 - whatever has that name
    if name in ("main", "run"):
        return getattr(importlib.import_module("shipid.cli.frame.group"), name)
    raise AttributeError(f"module 'shipid.cli' has no attribute '{name}'")


def entry() -> None:
    """Entry point of the installed command."""
    code: int = ExitCode.INTERRUPTED
    try:
        with watched():
            code = importlib.import_module("shipid.cli.frame.group").run()
            ignore_from_now()
    except KeyboardInterrupt:
        print("shipid: interrupted; nothing more was written.", file=sys.stderr)
    except Terminated:
        code = ExitCode.TERMINATED
    if code in (ExitCode.INTERRUPTED, ExitCode.TERMINATED):
        end_now(code)
    sys.exit(code)
