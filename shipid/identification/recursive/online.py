"""The same recursion for samples that arrive one by one, kept in a file between two watches."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.estimation.arrangement import LONGEST_GAP, LONGEST_STEP, column_of, input_table
from shipid.estimation.errors import SavedStateError
from shipid.estimation.run import ParameterEstimate, unpacked
from shipid.identification.recursive.following import following
from shipid.identification.recursive.recursion import FEW

if TYPE_CHECKING:
    from shipid.generation.loop import Stepper
    from shipid.identification.recursive.identifier import RecursiveIdentifier

_Z95 = 1.959963984540054


class OnlineIdentifier:
    """A recursion between two samples; made by `RecursiveIdentifier.start` and `restore`.

    Parameters
    ----------
    identifier : RecursiveIdentifier
        Which recursion.

    Attributes
    ----------
    t : float or None
        Time of the last sample in s.
    refused : int
        Samples left out because their time was not later than that of the one before.
    """

    def __init__(self, identifier: RecursiveIdentifier) -> None:
        self.identifier = identifier
        self.t: float | None = None
        self.refused = 0
        self._level = identifier.level_of()
        self._stepper: Stepper | None = None
        self._usual: float | None = None
        self._pending: dict[str, float] = {}

    def update(self, sample: Mapping[str, float]) -> dict[str, float]:
        """Take in one sample.

        Parameters
        ----------
        sample : mapping of str to float
            Time ``t`` in s, inputs, and the measured state unless it is missing, SI. An input that is missing keeps its value.

        Returns
        -------
        dict of str to float
            The estimates after it, SI.
        """
        made, places = self.identifier, self.identifier.layout.control
        t = float(sample["t"])
        if self.t is not None and not t > self.t:
            self.refused += 1
            return self.estimates
        self._pending |= {n: float(v) for n, v in sample.items() if np.isfinite(v)}
        model = made.regression.system.model
        columns = {n: np.array([v]) for n, v in (self._pending | {"t": t}).items()}
        inputs = input_table(model, columns, "of samples", made.inputs, made.regression.needed)[0]
        # The cruising speed is the one before the manoeuvre, not the one now.
        if (
            "cruise" in model.inputs
            and "cruise" not in self._pending
            and "u" in columns
            and "cruise" not in made.inputs
        ):
            self._pending["cruise"] = float(columns["u"][0])
        column = column_of(model, made.sensor, sample)
        z = float(sample[column]) if column is not None else np.nan
        there = bool(np.isfinite(z))
        if self._stepper is None:
            carried = made.carried(z if there else 0.0, inputs, self._level)
            self._stepper = made.loop.one_at_a_time(carried, made.constants(self._level))
        gap = 0.0 if self.t is None else min(t - self.t, LONGEST_GAP)
        control = self._stepper.control
        begin = self._stepper.z[made.layout.carried["u"]].copy()
        pieces = self._pieces(gap)
        for k in range(pieces):
            last = k == pieces - 1
            control[places["u"]] = begin + (inputs - begin) * (k + 1) / pieces
            control[places["T"]] = gap / pieces
            control[places["z"]] = z if there and last else 0.0
            control[places["there"]] = float(there and last)
            self._stepper.step()
        if self.t is not None and pieces == 1:
            self._usual = gap if self._usual is None else self._usual
        self.t = t
        return self.estimates

    def _pieces(self, gap: float) -> int:
        """In how many steps a gap is bridged, so that the integration stays accurate."""
        return 1 if not self._usual else max(1, int(np.ceil(gap / (LONGEST_STEP * self._usual) - 1e-9)))

    @property
    def estimates(self) -> dict[str, float]:
        """Parameters, and what follows from them, after the last sample, SI."""
        return {n: p.value for n, p in self.parameters.items()}

    @property
    def parameters(self) -> dict[str, ParameterEstimate]:
        """Parameters, and what follows from them, after the last sample, with 95 % intervals."""
        made, layout = self.identifier, self.identifier.layout
        if self._stepper is None:
            return {}
        z = self._stepper.z
        theta = np.array(z[layout.carried["theta"]])
        covariance = unpacked(z[layout.carried["joint"]][None, :], layout.n + 1)[0, 1:, 1:]
        count = float(z[layout.carried["count"]][0])
        if not made.method.believes_noise and count >= FEW * layout.n:
            covariance = covariance * float(z[layout.carried["nis"]][0]) / count
        values = {n: (theta[i], np.sqrt(max(covariance[i, i], 0.0))) for i, n in enumerate(made.names)}
        also = following(made.model, made.names, made.known, theta[None, :], covariance[None])
        values |= {n: (v[0], s[0]) for n, (v, s) in also.items()}
        result = {}
        for name, (value, std) in values.items():
            entry, value, std = made.model[name], float(value), float(std)
            ends = (value - _Z95 * std, value + _Z95 * std)
            result[name] = ParameterEstimate(name, entry.unit, entry.quantity.meaning, value, std, ends)
        return result

    def save(self, path: str | Path) -> None:
        """Write the state to a file, whole or not at all.

        Parameters
        ----------
        path : str or Path
            The file; it is replaced in one step.
        """
        path = Path(path)
        state: dict[str, Any] = {
            "belongs_to": signature(self.identifier),
            "t": self.t,
            "refused": self.refused,
            "usual": self._usual,
            "pending": self._pending,
            "carried": None if self._stepper is None else self._stepper.z.tolist(),
        }
        temporary = path.with_name(f".{path.name}.{os.getpid()}")
        temporary.write_text(json.dumps(state), encoding="utf-8")
        temporary.replace(path)

    @classmethod
    def restored(cls, identifier: RecursiveIdentifier, path: Path) -> OnlineIdentifier:
        """Return the recursion as `save` left it.

        Parameters
        ----------
        identifier : RecursiveIdentifier
            The same recursion as the one that was saved.
        path : Path
            The file.

        Raises
        ------
        SavedStateError
            If the file cannot be read, or belongs to another recursion.
        """
        try:
            state = json.loads(path.read_text(encoding="utf-8"))
            belongs = state["belongs_to"]
            online = cls(identifier)
            online.t, online.refused = state["t"], state["refused"]
            online._usual, online._pending = state["usual"], state["pending"]
            carried = state["carried"]
        except OSError as error:
            raise SavedStateError(f"the saved state {path} cannot be read: {error.strerror}.") from None
        except (ValueError, KeyError, TypeError):
            raise SavedStateError(f"{path} is no saved state of a recursive identification.") from None
        if belongs != signature(identifier):
            raise SavedStateError(
                f"the saved state {path} belongs to another recursion: model, ship, method, parameters and noise have to be those "
                "it was saved with. Make it with the same arguments, or start anew."
            )
        if carried is not None:
            online._stepper = identifier.loop.one_at_a_time(np.array(carried), identifier.constants(online._level))
        return online


def signature(identifier: RecursiveIdentifier) -> str:
    """Return a hash of everything a saved state depends on.

    Parameters
    ----------
    identifier : RecursiveIdentifier
        The recursion.
    """
    parts = (
        identifier.method.name,
        identifier.names,
        identifier.output,
        identifier.sensor,
        identifier.regression.system.digest,
        identifier.regression.integration,
        sorted(identifier.inputs.items()),
        identifier.constants(identifier.level_of()).tolist(),
    )
    return hashlib.sha256(repr(parts).encode()).hexdigest()
