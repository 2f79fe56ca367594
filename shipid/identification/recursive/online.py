"""The same recursion for samples that arrive one by one, kept in a file between two watches."""

from __future__ import annotations

import functools
import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.estimation.errors import SavedStateError
from shipid.estimation.records.arrangement import LONGEST_GAP, LONGEST_STEP, column_of, input_table
from shipid.estimation.records.run import unpacked
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.identification.recursive.following import followers, following
from shipid.identification.recursive.recursion import FEW

if TYPE_CHECKING:
    from shipid.generation.loop import Stepper
    from shipid.identification.recursive.identifier import RecursiveIdentifier


@dataclass(frozen=True, eq=False)
class RecursiveEstimate:
    """What is known after a sample.

    Attributes
    ----------
    t : float
        Time of the sample in s.
    y : float
        The measured state as the recursion remembers it, SI.
    theta : ndarray, shape (parameters,)
        Estimates, SI.
    covariance : ndarray, shape (parameters, parameters)
        Their covariance.
    refused : str
        Why the whole sample was refused; empty where it was not.
    """

    t: float
    y: float
    theta: np.ndarray
    covariance: np.ndarray
    refused: str
    _identifier: RecursiveIdentifier = field(repr=False)

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, and the published coefficients that follow from them."""
        made = self._identifier
        return (*made.names, *followers(made.model, made.names))

    @functools.cached_property
    def _values(self) -> dict[str, tuple[float, float]]:
        made = self._identifier
        std = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        also = following(made.model, made.names, made.known, self.theta[None, :], self.covariance[None])
        own = {n: (float(self.theta[i]), float(std[i])) for i, n in enumerate(made.names)}
        return own | {n: (float(v[0]), float(s[0])) for n, (v, s) in also.items()}

    def __getitem__(self, name: str) -> float:
        """Return the estimate of a parameter, or of what follows from them, SI."""
        if name not in self.names:
            raise UnknownNameError("estimated parameter", name, self.names)
        return self._values[name][0]

    def std_of(self, name: str) -> float:
        """Return a standard deviation, SI.

        Parameters
        ----------
        name : str
            A parameter, or a published coefficient that follows from them.
        """
        _ = self[name]
        return self._values[name][1]

    def to_dict(self) -> dict[str, Any]:
        """Return plain values, SI, free of NaN."""
        return {
            "t": self.t,
            "estimates": {n: {"value": _plain(v), "std": _plain(s)} for n, (v, s) in self._values.items()},
            "refused": self.refused,
        }


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
        self._held: dict[str, float] = {}

    def update(self, sample: Mapping[str, float]) -> RecursiveEstimate:
        """Take in one sample.

        Parameters
        ----------
        sample : mapping of str to float
            Time ``t`` in s, inputs, and the measured state unless it is missing, SI. An input that is missing keeps its value.

        Returns
        -------
        RecursiveEstimate

        Raises
        ------
        UsageError
            If the sample has no time.
        NotMeasurableError
            If the first sample lacks an input.
        """
        made, places = self.identifier, self.identifier.layout.control
        t = float(sample.get("t", np.nan))
        if not np.isfinite(t):
            raise UsageError("a sample needs its time 't' in s, a finite number.")
        if self.t is not None and not t > self.t:
            self.refused += 1
            return self._estimate(f"its time {t:g} s is not later than the last one, {self.t:g} s")
        inputs = self._inputs(sample)
        column = column_of(made.regression.system.model, made.sensor, sample)
        z = float(sample[column]) if column is not None else np.nan
        there = bool(np.isfinite(z))
        if self._stepper is None:
            carried = made.carried(z if there else 0.0, inputs, self._level)
            self._stepper = made.loop.one_at_a_time(carried, made.constants(self._level))
        gap = 0.0 if self.t is None else min(t - self.t, LONGEST_GAP)
        control = self._stepper.control
        begin = self._stepper.z[made.layout.carried["u"]].copy()
        pieces = self._pieces(gap)
        for k in range(1, pieces + 1):
            shows = there and k == pieces
            control[places["u"]] = begin + (inputs - begin) * (k / pieces)
            control[places["T"]] = gap / pieces
            control[places["z"]] = z if shows else 0.0
            control[places["there"]] = float(shows)
            self._stepper.step()
        if self._usual is None and self.t is not None:
            self._usual = gap
        self.t = t
        return self._estimate("")

    def _inputs(self, sample: Mapping[str, float]) -> np.ndarray:
        made, model = self.identifier, self.identifier.regression.system.model
        self._held |= {n: float(v) for n, v in sample.items() if np.isfinite(v)}
        # The cruising speed is the one before the manoeuvre, not the one now.
        if "cruise" in made.regression.needed and "u" in self._held and "cruise" not in made.inputs:
            self._held.setdefault("cruise", self._held["u"])
        columns = {n: np.array([v]) for n, v in self._held.items()}
        inputs: np.ndarray = input_table(model, columns, "of samples", made.inputs, made.regression.needed)[0]
        return inputs

    def _pieces(self, gap: float) -> int:
        """In how many steps a gap is bridged, so that the integration stays accurate."""
        return 1 if not self._usual else max(1, int(np.ceil(gap / (LONGEST_STEP * self._usual) - 1e-9)))

    @property
    def estimate(self) -> RecursiveEstimate | None:
        """What is known after the last sample; None before the first."""
        return None if self._stepper is None else self._estimate("")

    def _estimate(self, refused: str) -> RecursiveEstimate:
        assert self._stepper is not None and self.t is not None
        made, layout, z = self.identifier, self.identifier.layout, self._stepper.z
        covariance = unpacked(z[layout.carried["joint"]][None, :], layout.n + 1)[0, 1:, 1:]
        count = float(z[layout.carried["count"]][0])
        if not made.method.believes_noise and count >= FEW * layout.n:
            covariance = covariance * (float(z[layout.carried["nis"]][0]) / count)
        theta = np.array(z[layout.carried["theta"]])
        return RecursiveEstimate(self.t, float(z[layout.carried["y"]][0]), theta, covariance, refused, made)

    def save(self, path: str | Path) -> None:
        """Write the state to a file, whole or not at all; every number exactly.

        Parameters
        ----------
        path : str or Path
            A JSON file; one that exists is replaced.

        Raises
        ------
        UsageError
            If no sample has come yet.
        """
        if self._stepper is None:
            raise UsageError("a recursion that has taken no sample has no state to save.")
        path = Path(path)
        state: dict[str, Any] = {
            "belongs_to": signature(self.identifier),
            "t": self.t,
            "refused": self.refused,
            "usual": self._usual,
            "held": self._held,
            "carried": self._stepper.z.tolist(),
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
        online = cls(identifier)
        try:
            state = json.loads(path.read_text(encoding="utf-8"))
            belongs, carried = state["belongs_to"], np.array(state["carried"], dtype=float)
            online.t, online.refused = state["t"], state["refused"]
            online._usual, online._held = state["usual"], state["held"]
        except OSError as error:
            raise SavedStateError(f"the saved state {path} cannot be read: {error.strerror}.") from None
        except (ValueError, KeyError, TypeError):
            raise SavedStateError(f"{path} is no saved state of a recursive identification.") from None
        if belongs != signature(identifier):
            raise SavedStateError(
                f"the saved state {path} belongs to another recursion: model, ship, method, parameters and noise have to be those "
                "it was saved with. Make it with the same arguments, or start anew."
            )
        online._stepper = identifier.loop.one_at_a_time(carried, identifier.constants(online._level))
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


def _plain(value: float) -> float | None:
    """A number for JSON, which knows neither NaN nor infinity."""
    return value if np.isfinite(value) else None
