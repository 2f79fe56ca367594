"""The exact information matrix of a manoeuvre about the coefficients of a model, before the trial.

The manoeuvre is simulated in closed loop (helmsman, steering machine, ship). What identification will have is the rudder
that came out of it, so the model is run once more over that rudder, with its exact sensitivities by the coefficients and by
the unknowns every trial has of its own: initial states, rudder bias, speed before the manoeuvre, current. Weighted with the
noise of the sensors, their squares are the information matrix; the unknowns of the trial are eliminated (Schur complement), so
that matrices of different manoeuvres add. A longer run of the same manoeuvre holds the shorter ones, so one run serves all
lengths.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.generation.simulator import Simulator, make_simulator
from shipid.parts.manoeuvring_range import manoeuvring_range
from shipid.parts.rudder_delay import gear_of, recorded_rudder, steered_by
from shipid.trials.manoeuvres.manoeuvre import Manoeuvre, parse_manoeuvre, plan, steps_of_helm

#: Samples in L/U of the record that is differentiated; how often sensors sample is in the weights.
PER_UNIT_TIME = 12
#: Sensitivity, in standard deviations for a change of a coefficient by its own size, beyond which squares mean nothing.
_STEEP = 1e12
#: Part of the largest singular value below which a direction is lost in rounding.
_ROUNDING = 1e-8
#: Growth of an error in the initial rate of turn beyond which the record of an unstable ship cannot be followed or fitted.
_GROWTH = 3.0
#: The source of an input, for messages.
_WHERE = "a plan"


@dataclass(frozen=True)
class CandidateManoeuvre:
    """A manoeuvre that may be chosen, at a speed.

    Attributes
    ----------
    manoeuvre : Manoeuvre
        Which.
    speed : float
        Speed of the approach in m/s.
    seed : int
        Of the random telegraph; nothing else reads it.
    """

    manoeuvre: Manoeuvre
    speed: float
    seed: int = 0

    @property
    def rudder(self) -> float | None:
        """Largest rudder angle it orders in rad, or None where the ship's own limit is the only one."""
        kind, numbers = self.manoeuvre.kind, self.manoeuvre.numbers
        if kind == "reversed-spiral":
            return None
        if kind == "course":
            return abs(numbers[1]) if len(numbers) > 1 else None
        return abs(numbers[0])


@dataclass(frozen=True, eq=False)
class Experiment:
    """The coefficients to estimate, the signals, and the other unknowns.

    Attributes
    ----------
    model : Model
        The model that will be identified.
    length : float
        Length of the ship in m.
    estimated : tuple of str
        The coefficients.
    initial, biases : tuple of str
        States and inputs with an unknown of their own in each trial.
    signals : tuple of str
        Fitted signals.
    sigma : ndarray, shape (signals,)
        Standard deviation of one sample of each, SI.
    rate : float
        Independent samples in a second.
    limit : float
        Largest rudder angle of the ship in rad.
    """

    model: Model
    length: float
    estimated: tuple[str, ...]
    initial: tuple[str, ...]
    biases: tuple[str, ...]
    signals: tuple[str, ...]
    sigma: np.ndarray
    rate: float
    limit: float

    @property
    def simulator(self) -> Simulator:
        """The model as identification will run it, with its sensitivities."""
        return make_simulator(
            self.model, self.signals, coefficients=self.estimated, initial=self.initial, biases=self.biases
        )

    def interval(self, speed: float) -> float:
        """Return the sampling interval of the differentiated record in s.

        Parameters
        ----------
        speed : float
            Speed of the approach in m/s.
        """
        return self.length / speed / PER_UNIT_TIME

    def rudder_of(
        self, candidate: CandidateManoeuvre, duration: float, known: Mapping[str, float]
    ) -> np.ndarray | None:
        """Simulate a manoeuvre in closed loop and return the rudder angle that came of it.

        Parameters
        ----------
        candidate : CandidateManoeuvre
            The manoeuvre.
        duration : float
            In s.
        known : mapping of str to float
            Coefficients and constants, SI, those of the steering machine included.

        Returns
        -------
        ndarray or None, shape (N,)
            In rad, at the samples of the differentiated record; None where the model does not sail it.
        """
        speed = candidate.speed
        unit, interval = self.length / speed, self.interval(speed)
        planned = plan(candidate.manoeuvre, unit, 0.0, self.limit, candidate.seed, duration, known.get("delta_rate"))
        steered = _steered(self.model, planned.helm)
        fine = steps_of_helm(interval, unit)
        t = np.arange((int(duration / interval + 1e-9)) * fine + 1) * (interval / fine)
        schedule = planned.scheduled(t) if planned.schedule else 0.0
        inputs = _approach(speed) | {"helm_schedule": schedule}
        given = {**known, **planned.constants, "L": self.length}
        run = steered(t, given, inputs, {"u": speed, "psi": 0.0}, where=_WHERE)
        return None if run.departure is not None else run[_recorded(self.model, steered.model)][::fine]

    def information(
        self, candidate: CandidateManoeuvre, durations: Sequence[float], known: Mapping[str, float], size: np.ndarray
    ) -> np.ndarray | None:
        """Return the information about the coefficients in one manoeuvre, for each of its lengths.

        Parameters
        ----------
        candidate : CandidateManoeuvre
            The manoeuvre.
        durations : sequence of float
            Lengths in s, rising.
        known : mapping of str to float
            Coefficients and constants, SI.
        size : ndarray, shape (estimated,)
            A typical size of each coefficient; the information is in units of it.

        Returns
        -------
        ndarray, shape (durations, estimated, estimated), or None
            The longest are left out where the ship is so unstable that the record cannot be followed from its beginning;
            None where that holds for all, or the model runs away.
        """
        rudder = self.rudder_of(candidate, durations[-1], known)
        if rudder is None:
            return None
        speed, interval = candidate.speed, self.interval(candidate.speed)
        inputs = _approach(speed) | {steered_by(self.model) or "delta": rudder}
        t = np.arange(rudder.size) * interval
        slope = self.simulator(t, known, inputs, {"u": speed, "psi": 0.0}, where=_WHERE).slopes.copy()
        slope[:, : size.size] *= size[:, None]
        slope /= self.sigma[:, None, None]
        if not (np.abs(slope) < _STEEP).all():
            return None
        ends = [int(d / interval + 1e-9) + 1 for d in durations]
        good = [e for e in ends if e <= self._followed(slope)]
        return eliminate(gather(slope, good), size.size) * (self.rate * interval) if good else None

    def _followed(self, slope: np.ndarray) -> int:
        """Samples until an error in the initial rate of turn has grown too much to follow."""
        if "r" not in self.signals:
            return int(slope.shape[2])
        first = len(self.estimated)
        rates = np.abs(slope[self.signals.index("r"), first : first + len(self.initial)])
        rates = rates[rates[:, 0] > 0]
        lost = (rates > _GROWTH * rates[:, :1]).any(axis=0)
        return int(np.argmax(lost) if lost.any() else slope.shape[2])


def _approach(speed: float) -> dict[str, float | np.ndarray]:
    """The inputs before the rudder moves."""
    return {"u": speed, "cruise": speed}


@functools.lru_cache(maxsize=64)
def _steered(model: Model, helm: type[Component]) -> Simulator:
    """The closed loop of one helmsman: it shows the rudder, and whether the model sails the manoeuvre."""
    whole = join(model.name, model, *gear_of(model), helm, *manoeuvring_range(model))
    return make_simulator(whole, (_recorded(model, whole),), hold="zero")


def _recorded(model: Model, whole: Model) -> str:
    """What a log holds of the input by which a model is steered, of the model in closed loop."""
    return recorded_rudder(whole) if steered_by(model) == "delta" else "delta_order"


def gather(slope: np.ndarray, ends: Sequence[int]) -> np.ndarray:
    """Return triangular factors of the information matrices of all unknowns in the first samples of a record.

    Parameters
    ----------
    slope : ndarray, shape (signals, unknowns, N)
        Derivatives of the signals by the unknowns, in standard deviations.
    ends : sequence of int
        Numbers of samples, rising.

    Returns
    -------
    ndarray, shape (ends, unknowns, unknowns)
        R with R' R = J' J, exact to rounding where J' J itself would have lost half of the digits.
    """
    unknowns = slope.shape[1]
    triangle, out = np.zeros((unknowns, unknowns)), []
    for begin, end in itertools.pairwise([0, *ends]):
        piece = slope[:, :, begin:end].transpose(0, 2, 1).reshape(-1, unknowns)
        triangle = np.asarray(np.linalg.qr(np.vstack([triangle, piece]), mode="r"))
        out.append(triangle)
    return np.stack(out)


def eliminate(triangle: np.ndarray, kept: int) -> np.ndarray:
    """Return the information about the first unknowns when the others are unknown as well (Schur complement).

    With R' R the information of all unknowns, it is what is left of the first columns of R when they are projected off
    the span of the others: never negative, even where the others cannot be separated.

    Parameters
    ----------
    triangle : ndarray, shape (..., M, unknowns)
        R, or the whole Jacobian.
    kept : int
        How many of the unknowns are kept.

    Returns
    -------
    ndarray, shape (..., kept, kept)
    """
    wanted, others = triangle[..., :kept], triangle[..., kept:]
    norms = np.linalg.norm(others, axis=-2, keepdims=True)
    basis, singular, _ = np.linalg.svd(others / np.where(norms > 0, norms, 1.0), full_matrices=False)
    seen = singular > _ROUNDING * np.maximum(singular.max(axis=-1, keepdims=True, initial=0.0), 1e-300)
    basis = basis * seen[..., None, :]
    left = wanted - basis @ (basis.swapaxes(-1, -2) @ wanted)
    return np.asarray(left.swapaxes(-1, -2) @ left)


def covariance_from(information: np.ndarray) -> np.ndarray:
    """Return the covariance that belongs to an information matrix, infinite where there is no information.

    Parameters
    ----------
    information : ndarray, shape (n, n)
        Symmetric, not negative.

    Returns
    -------
    ndarray, shape (n, n)
        An unknown that takes part in a direction without information has an infinite variance and no covariance.
    """
    norms = np.sqrt(np.clip(np.diag(information), 0.0, None))
    lost = norms <= _STEEP**-0.5
    safe = np.where(lost, 1.0, norms)
    values, vectors = np.linalg.eigh(information / np.outer(safe, safe))
    # An unknown without any information is a direction of its own.
    small = values < 1e-14 * max(values.max(initial=0.0), 1e-300)
    lost = lost | (np.abs(vectors[:, small]) > 1e-3).any(axis=1)
    inverse = np.where(small, 0.0, 1 / np.where(small, 1.0, values))
    matrix = np.asarray((vectors * inverse) @ vectors.T / np.outer(safe, safe))
    matrix[lost, :] = matrix[:, lost] = 0.0
    matrix[lost, lost] = np.inf
    return matrix


def candidate_of(text: str, speed: float, seed: int = 0) -> CandidateManoeuvre:
    """Return a manoeuvre that may be chosen from its text.

    Parameters
    ----------
    text : str
        As in ``"zigzag:20/20"``.
    speed : float
        In m/s.
    seed : int
        Of the random telegraph.
    """
    return CandidateManoeuvre(parse_manoeuvre(text), speed, seed)
