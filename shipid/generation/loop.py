"""A step run over a whole record: in C where there is a compiler, on the virtual machine otherwise.

The loop over the samples stands in C beside the generated step, so that a record of any length costs one call, a sample
that has just arrived costs little more than its arithmetic, and threads run records side by side (the call releases
Python's lock).
"""

from __future__ import annotations

import ctypes
import functools
import itertools
import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TypeAlias

import casadi as ca
import numpy as np

from shipid.foundation.aliases import CasadiFunction
from shipid.generation.compiling import compile_library

#: The loop: two copies of the carried state are used in turn, since a step may not write over what it still reads.
_LOOP = """
#include <string.h>
#ifdef _WIN32
#define SHIPID_EXPORT __declspec(dllexport)
#else
#define SHIPID_EXPORT
#endif
SHIPID_EXPORT int shipid_loop(const casadi_real* z0, const casadi_real* c, const casadi_real* p, casadi_real* z,
                              casadi_real* out, long long n) {{
  static const int nz = {nz}, nc = {nc}, no = {no};
  const casadi_real* arg[{args}];
  casadi_real* res[{results}];
  casadi_int iw[{iw}];
  casadi_real w[{w}], one[{room}], two[{room}];
  casadi_real *now = one, *then = two, *swap;
  long long k;
  int failed = 0;
  memcpy(now, z0, nz * sizeof(casadi_real));
  for (k = 0; k < n && !failed; ++k) {{
    arg[0] = now; arg[1] = c + k * nc; arg[2] = p;
    res[0] = then; res[1] = out ? out + k * no : 0;
    failed = {name}(arg, res, iw, w, 0);
    swap = now; now = then; then = swap;
  }}
  memcpy(z, now, nz * sizeof(casadi_real));
  return failed;
}}
/* Many records of one length, one after the other; a stride of zero gives all of them the same samples. */
SHIPID_EXPORT int shipid_records(const casadi_real* z0, const casadi_real* c, const casadi_real* p, casadi_real* z,
                                 casadi_real* out, long long n, long long records, long long stride) {{
  static const int nz = {nz}, np = {np}, no = {no};
  long long k;
  int failed = 0;
  for (k = 0; k < records && !failed; ++k)
    failed = shipid_loop(z0 + k * nz, c + k * stride, p + k * np, z + k * nz, out + k * n * no, n);
  return failed;
}}
/* One sample; one argument, since each costs Python a conversion. */
SHIPID_EXPORT int shipid_once(void* const* a) {{
  return shipid_loop((const casadi_real*)a[0], (const casadi_real*)a[1], (const casadi_real*)a[2], (casadi_real*)a[3],
                     (casadi_real*)a[4], 1);
}}
"""


#: State before the first sample, controls and coefficients of one record.
_Record: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class Loop:
    """The step ``(z, c, p) -> (z_next, out)`` over the samples of a record; made by `make_loop`.

    Attributes
    ----------
    step : casadi.Function
        One sample: carried state z, control c, coefficients p; all dense columns.
    compiled : bool
        Whether it runs as machine code.
    single : bool
        Whether it computes in single precision (compiled only).
    call, library : ctypes objects or None
        The loop as machine code, and the library that holds it; None where nothing is compiled.
    """

    step: CasadiFunction
    compiled: bool
    single: bool
    call: CasadiFunction = field(repr=False, default=None)
    library: CasadiFunction = field(repr=False, default=None)

    @property
    def sizes(self) -> tuple[int, int, int, int]:
        """Lengths of z, c, p and out."""
        z, c, p = (self.step.size1_in(i) for i in range(3))
        return z, c, p, self.step.size1_out(1)

    @property
    def dtype(self) -> type[np.floating]:
        """Type of the numbers it computes with."""
        return np.float32 if self.single else np.float64

    def __call__(self, z0: np.ndarray, controls: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Run a record.

        Parameters
        ----------
        z0 : ndarray, shape (z,)
            State before the first sample.
        controls : ndarray, shape (N, c)
            One row a sample.
        p : ndarray, shape (p,)
            Coefficients.

        Returns
        -------
        z : ndarray, shape (z,)
            State after the last sample.
        out : ndarray, shape (N, out)
            Outputs, one row a sample.

        Raises
        ------
        ValueError
            If the shapes do not fit the step.
        """
        record = self._fitting(z0, controls, p)
        return self._run(record, np.empty((len(record[1]), self.sizes[3]), self.dtype))

    def _fitting(self, z0: np.ndarray, controls: np.ndarray, p: np.ndarray) -> _Record:
        """A record as the machine code reads it: plain memory, in which a wrong shape would not be found."""
        nz, nc, n_p, _ = self.sizes
        z0, p = (np.ascontiguousarray(a, dtype=self.dtype) for a in (z0, p))
        controls = np.ascontiguousarray(controls, dtype=self.dtype)
        if z0.shape != (nz,) or p.shape != (n_p,) or controls.shape != (len(controls), nc):
            raise ValueError(f"shapes {z0.shape}, {controls.shape}, {p.shape} do not fit the step {self.sizes}")
        return z0, controls, p

    def _run(self, record: _Record, out: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Run a record that fits; its outputs are written to `out` where the code is compiled."""
        if self.call is None:
            return self._interpreted(*record)
        z0, controls, p = record
        z = np.empty(len(z0), self.dtype)
        self.call(z0.ctypes.data, controls.ctypes.data, p.ctypes.data, z.ctypes.data, out.ctypes.data, len(controls))
        return z, out

    def _interpreted(self, z0: np.ndarray, controls: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        count = controls.shape[0]
        if not count:
            return z0.copy(), np.empty((0, self.sizes[3]))
        z, out = _accumulated(self, count)(z0, controls.T, p)
        # A whole record is one call, so the copy through CasADi's matrices is one copy.
        return z.full()[:, -1], np.ascontiguousarray(out.full().T)

    def map(
        self,
        z0: Iterable[np.ndarray],
        controls: Iterable[np.ndarray],
        p: Iterable[np.ndarray],
        threads: int | None = None,
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Run many records, side by side on several threads where the code is compiled.

        Parameters
        ----------
        z0, controls, p : iterable of ndarray
            As for one record, one entry each.
        threads : int, optional
            How many; by default one for each processor.

        Returns
        -------
        list of tuple of ndarray
            As for one record, one entry each.
        """
        records = [self._fitting(*each) for each in zip(z0, controls, p)]
        rows = np.cumsum([0, *(len(c) for _, c, _ in records)]).tolist()
        # One block for all outputs: to be given many small ones by the system takes as long as the arithmetic.
        block = np.empty((rows[-1], self.sizes[3]), self.dtype)

        def some(first: int, last: int) -> list[tuple[np.ndarray, np.ndarray]]:
            return [self._run(records[k], block[rows[k] : rows[k + 1]]) for k in range(first, last)]

        workers = min(threads or os.cpu_count() or 1, len(records))
        if workers <= 1 or self.call is None:
            return some(0, len(records))
        # Several records a task, since handing over costs time; several tasks a thread, since lengths differ.
        ends = np.linspace(0, len(records), 4 * workers + 1).astype(int).tolist()
        with ThreadPoolExecutor(workers) as pool:
            return list(itertools.chain.from_iterable(pool.map(some, ends[:-1], ends[1:])))

    def side_by_side(
        self, z0: np.ndarray, controls: np.ndarray, p: np.ndarray, threads: int | None = None
    ) -> np.ndarray:
        """Run records of one length, one call of the machine code a thread, and return their outputs.

        Parameters
        ----------
        z0 : ndarray, shape (R, z)
            States before the first samples.
        controls : ndarray, shape (R, N, c) or (N, c)
            One row a sample; without the first axis, every record has the same.
        p : ndarray, shape (R, p)
            Coefficients.
        threads : int, optional
            How many; by default one for each processor.

        Returns
        -------
        ndarray, shape (R, N, out)

        Raises
        ------
        ValueError
            If the shapes do not fit the step.
        """
        nz, nc, n_p, no = self.sizes
        z0, controls, p = (np.ascontiguousarray(a, dtype=self.dtype) for a in (z0, controls, p))
        runs, count, shared = len(z0), controls.shape[-2], controls.ndim == 2
        if z0.shape != (runs, nz) or p.shape != (runs, n_p) or controls.shape not in ((count, nc), (runs, count, nc)):
            raise ValueError(f"shapes {z0.shape}, {controls.shape}, {p.shape} do not fit the step {self.sizes}")
        if self.call is None:
            return np.stack([self(z0[k], controls if shared else controls[k], p[k])[1] for k in range(runs)])
        z, out = np.empty((runs, nz), self.dtype), np.empty((runs, count, no), self.dtype)
        stride = 0 if shared else count * nc

        def some(first: int, last: int) -> None:
            arrays = (z0[first:], controls if shared else controls[first:], p[first:], z[first:], out[first:])
            places = (a.ctypes.data for a in arrays)
            self.library.shipid_records(*places, count, last - first, stride)

        workers = min(threads or os.cpu_count() or 1, runs)
        ends = np.linspace(0, runs, workers + 1).astype(int).tolist()
        if workers <= 1:
            some(0, runs)
        else:
            with ThreadPoolExecutor(workers) as pool:
                list(pool.map(some, ends[:-1], ends[1:]))
        return out

    def one_at_a_time(self, z0: np.ndarray, p: np.ndarray) -> Stepper:
        """Return the same step for samples that arrive one by one.

        Parameters
        ----------
        z0, p : ndarray
            As for a record.
        """
        return Stepper(self, z0, p)

    def __hash__(self) -> int:
        return id(self)


class Stepper:
    """One sample at a time, on memory that is laid out once.

    Write the sample into `control`, call `step`, and read `out` and `z`.

    Parameters
    ----------
    loop : Loop
        What it steps.
    z0, p : ndarray
        State before the first sample, and coefficients.
    """

    def __init__(self, loop: Loop, z0: np.ndarray, p: np.ndarray) -> None:
        nz, nc, n_p, no = loop.sizes
        self.z, self.p = np.array(z0, dtype=loop.dtype), np.array(p, dtype=loop.dtype)
        if self.z.shape != (nz,) or self.p.shape != (n_p,):
            raise ValueError(f"shapes {self.z.shape}, {self.p.shape} do not fit the step {loop.sizes}")
        self.control, self.out = np.zeros(nc, loop.dtype), np.zeros(no, loop.dtype)
        self._loop = loop
        if loop.call is None:
            self.step = self._interpreted
        else:
            # The state is copied in before it is written out, so one array serves as both.
            places = (self.z, self.control, self.p, self.z, self.out)
            self._pointers = (ctypes.c_void_p * len(places))(*(a.ctypes.data for a in places))
            once = loop.library.shipid_once
            once.argtypes, once.restype = [ctypes.c_void_p], ctypes.c_int
            self.step = functools.partial(once, ctypes.addressof(self._pointers))

    def _interpreted(self) -> int:
        z, out = self._loop.step(self.z, self.control, self.p)
        self.z[:], self.out[:] = z.full().ravel(), out.full().ravel()
        return 0


@functools.lru_cache(maxsize=256)
def _accumulated(loop: Loop, count: int) -> CasadiFunction:
    nz, nc, n_p, _ = loop.sizes
    z0, controls, p = ca.MX.sym("z0", nz), ca.MX.sym("c", nc, count), ca.MX.sym("p", n_p)
    z, out = loop.step.mapaccum(count)(z0, controls, ca.repmat(p, 1, count))
    return ca.Function("record", [z0, controls, p], [z, out])


def make_loop(step: CasadiFunction, compiled: bool = True, single: bool = False) -> Loop:
    """Compile a step together with the loop over its samples.

    Parameters
    ----------
    step : casadi.Function
        ``(z, c, p) -> (z_next, out)``: dense columns, no callbacks.
    compiled : bool
        Whether to compile; without a compiler the virtual machine runs it, with one notice.
    single : bool
        Whether to compute in single precision, as a small target machine does; needs a compiler.

    Returns
    -------
    Loop

    Raises
    ------
    ValueError
        If the step does not return what it carries.
    """
    nz, no = step.size1_in(0), step.size1_out(1)
    # The state of one sample is copied into the next: another length would run over the memory.
    if step.size_out(0) != step.size_in(0) or step.size2_out(1) != 1:
        raise ValueError(f"a step returns what it carries, and {step} does not")
    library = None
    # A name of our own: a library that is loaded already may export one as short as "step", and would be called instead.
    symbols = step.sx_in() if step.is_a("SXFunction") else step.mx_in()
    step = ca.Function("shipid_sample", symbols, step.call(symbols))
    if compiled or single:
        text = _LOOP.format(
            nz=nz,
            nc=step.size1_in(1),
            np=step.size1_in(2),
            no=no,
            name=step.name(),
            args=max(3, step.sz_arg()),
            results=max(2, step.sz_res()),
            iw=max(1, step.sz_iw()),
            w=max(1, step.sz_w()),
            room=max(1, nz),
        )
        library = compile_library(step, text, single)
    if library is None:
        return Loop(step, False, False)
    call = library.shipid_loop
    call.argtypes, call.restype = [ctypes.c_void_p] * 5 + [ctypes.c_longlong], ctypes.c_int
    records = library.shipid_records
    records.argtypes, records.restype = [ctypes.c_void_p] * 5 + [ctypes.c_longlong] * 3, ctypes.c_int
    return Loop(step, True, single, call, library)
