"""Generated C is compiled once and kept in a cache under a hash of source, compiler and flags.

Without a compiler the CasADi virtual machine runs several times slower (`studies/speed.py`); one notice says so.
"""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import shutil
import subprocess
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import casadi as ca

from shipid.foundation.aliases import CasadiFunction
from shipid.foundation.cache import digest, safe_cache_folder, workshop
from shipid.foundation.errors import ShipidError
from shipid.foundation.replacing import put_in_place

#: Above -O1 the compilation of generated code takes half as long again, that of long code a minute; filters and simulations run no
#: faster for it.
FLAGS = ("-O1", "-fPIC", "-shared")


class CompilerNotice(UserWarning):
    """Generated code runs on the virtual machine because it could not be compiled."""


@functools.cache
def find_compiler() -> tuple[str, str] | None:
    """Return the path and the version line of the C compiler, or None."""
    for candidate in (os.environ.get("CC"), "cc", "gcc", "clang"):
        path = shutil.which(candidate) if candidate else None
        if path is None:
            continue
        try:
            answer = subprocess.run([path, "--version"], capture_output=True, text=True, timeout=20, check=True)
        except (OSError, subprocess.SubprocessError):
            continue
        return path, answer.stdout.partition("\n")[0]
    return None


@functools.cache
def notice_once(reason: str) -> None:
    """Warn that generated code is not compiled, once for each reason.

    Parameters
    ----------
    reason : str
        Why not.
    """
    warnings.warn(
        f"generated code is not compiled ({reason}); it runs on CasADi's virtual machine, several times slower.",
        CompilerNotice,
        stacklevel=4,
    )


def compile_function(function: CasadiFunction) -> CasadiFunction:
    """Return the compiled form of a CasADi function, from the cache where it has been compiled before.

    Parameters
    ----------
    function : casadi.Function
        A function without callbacks.

    Returns
    -------
    casadi.Function
        The same function as machine code, or unchanged where there is no compiler or it failed (with one notice).
        ``SHIPID_COMPILE=0`` in the environment leaves every function unchanged.
    """
    return _compiled(function, lambda path: ca.external(function.name(), str(path))) or function


def compile_library(function: CasadiFunction, beside: str, single: bool = False) -> CasadiFunction:
    """Compile a CasADi function together with C code of our own that calls it.

    Parameters
    ----------
    function : casadi.Function
        A function without callbacks.
    beside : str
        C code that follows the generated one in the same file.
    single : bool
        Whether numbers are ``float`` instead of ``double``.

    Returns
    -------
    ctypes.CDLL or None
        None where nothing can be compiled (`compile_function` says when); with one notice.
    """
    return _compiled(function, lambda path: ctypes.CDLL(str(path)), beside, single)


def _compiled(
    function: CasadiFunction, load: Callable[[Path], Any], beside: str = "", single: bool = False
) -> CasadiFunction:
    """Generate, compile and load; None where that fails."""
    if os.environ.get("SHIPID_COMPILE") == "0":
        return None
    compiler = find_compiler()
    if compiler is None:
        notice_once("no C compiler found; install gcc or clang, or set CC")
        return None
    options: dict[str, Any] = {"with_header": False}
    if single:
        options["casadi_real"] = "float"
    generator = ca.CodeGenerator("shipid_code.c", options)
    generator.add(function)
    source = generator.dump() + beside
    key = hashlib.sha256("\0".join((source, *compiler, *FLAGS)).encode()).hexdigest()[:32]
    try:
        return _kept(key, load) or _built(source, key, compiler[0], load)
    except (OSError, RuntimeError, ShipidError, subprocess.SubprocessError) as error:
        detail = getattr(error, "stderr", "") or str(error)
        notice_once(f"compiling failed: {detail.strip()[:200]}")
        return None


def _kept(key: str, load: Callable[[Path], Any]) -> CasadiFunction:
    """Load what was compiled before; None where there is nothing, or nothing whole.

    The name of a library ends with the checksum of its content: a damaged one would be executed as it is.
    """
    folder = safe_cache_folder()
    for library in sorted(folder.glob(f"{key}-*.so")) if folder is not None else ():
        if library.is_file() and library.name == _name(key, library.read_bytes()):
            return load(library)
        with suppress(OSError):
            library.unlink()
    return None


def _built(source: str, key: str, compiler: str, load: Callable[[Path], Any]) -> CasadiFunction:
    """Compile under a temporary name, put the library into the cache, and load it: other processes never read half a file."""
    folder = safe_cache_folder()
    with workshop(folder) as scratch:
        (scratch / "code.c").write_text(source)
        # Relative names: a compiler that fails says the same each time, and is reported once.
        command = [compiler, *FLAGS, "-o", "code.so", "code.c", "-lm"]
        subprocess.run(command, capture_output=True, text=True, timeout=300, check=True, cwd=scratch)
        made = scratch / "code.so"
        if folder is None:
            return load(made)  # what is loaded stays, also where its file is removed
        library = folder / _name(key, made.read_bytes())
        put_in_place({made: library}, overwrite=True)
    return load(library)


def _name(key: str, content: bytes) -> str:
    return f"{key}-{digest(content)[:32]}.so"
