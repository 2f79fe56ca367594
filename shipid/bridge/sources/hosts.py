"""Hosts on a network: a name that can be none is refused at once, and not tried for ever; why one was not reached."""

from __future__ import annotations

import os
import socket

from shipid.foundation.errors import UsageError


def check_host(host: str) -> None:
    """Check that a name can be that of a host.

    Parameters
    ----------
    host : str
        The name or the address.

    Raises
    ------
    UsageError
        If no host can be called so.
    """
    try:
        host.encode("idna")
        sound = host.isprintable()
    except UnicodeError:
        sound = False
    if not sound:
        raise UsageError(f"'{host[:40]}' is no name of a host: check it.")


def why_not_reached(error: Exception) -> str:
    """Return in words why a host was not reached; empty where the system does not say.

    Parameters
    ----------
    error : Exception
        Of the connection.
    """
    if not isinstance(error, OSError):
        return " ".join(str(error).split())[:120]
    # The number of an unknown name is of another list, and what asyncio says of an address is for programmers.
    return error.strerror or "" if isinstance(error, socket.gaierror) or not error.errno else os.strerror(error.errno)
