"""Names of hosts: one that can be none is refused at once, and not tried for ever."""

from __future__ import annotations

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
