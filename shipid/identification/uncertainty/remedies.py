"""Trials that would narrow a null direction: other manoeuvres, another speed, missing signals, by their information."""

from __future__ import annotations

import functools
from collections.abc import Iterator

import numpy as np

from shipid.foundation.errors import ShipidError
from shipid.foundation.numbers import brief
from shipid.generation.system import generate
from shipid.identification.identified import Identified
from shipid.identification.problem.prior import structural_errors
from shipid.identification.problem.signals import SIGNALS, is_predicted, unknown_biases
from shipid.identification.uncertainty.information import CandidateManoeuvre, Experiment
from shipid.parts.rudder_delay import steered_by
from shipid.trials.manoeuvres.manoeuvre import parse_manoeuvre

#: A manoeuvre helps if it narrows the direction to this part; a pair of trials of one kind gives 0.7.
_HELPS = 0.5
_MANOEUVRES = ("zigzag:5/5", "zigzag:10/10", "zigzag:20/20", "zigzag:30/20", "turn:20", "turn:35")
#: Signals in words.
SIGNAL_WORDS = {"v": "the sway speed", "u": "the forward speed", "r": "the rate of turn", "psi": "the heading"}


def share_words(share: float) -> str:
    """Return a share in per cent, with two figures below one.

    Parameters
    ----------
    share : float
        1 is 100 %.
    """
    return f"{brief(100 * share, 2)} %" if share < 0.995 else f"{100 * share:.0f} %"


class Remedies:
    """Manoeuvres and signals that would narrow a direction; their information is computed at the first request.

    Parameters
    ----------
    identified : Identified
        What was identified.
    relative : ndarray, shape (parameters, parameters)
        Covariance of the coefficients in units of their size.
    size : ndarray, shape (parameters,)
        That size, SI.
    """

    def __init__(self, identified: Identified, relative: np.ndarray, size: np.ndarray) -> None:
        self._identified, self._relative, self._size = identified, relative, size

    def words(self, vector: np.ndarray, deviation: float | None) -> str:
        """Return what would help with one direction, in words.

        Parameters
        ----------
        vector : ndarray, shape (parameters,)
            The direction, in units of the size of the coefficients.
        deviation : float or None
            Relative standard deviation along it; None where no data determine it.
        """
        if not self._candidates:
            return "What would help: other amplitudes and speeds, or holding one of them at a value that is known."
        unit = vector / np.linalg.norm(vector)
        before = float(np.sqrt(unit @ self._relative @ unit))
        inverse = np.linalg.inv(self._relative)
        variances = [float(unit @ np.linalg.inv(inverse + matrix) @ unit) for _, matrix in self._candidates]
        # Where a combination has no information, rounding may leave a variance below zero.
        ratios = [float(np.sqrt(max(variance, 0.0))) / before for variance in variances]
        helping = [k for k, ratio in enumerate(ratios) if ratio < _HELPS]
        if not helping:
            best = int(np.argmin(ratios))
            if ratios[best] > 0.9 or deviation is None:
                return (
                    "No other manoeuvre or signal separates them in this model: only the combination matters. Hold one of them at "
                    "a value that is known, or choose a model without it."
                )
            return (
                f"{self._candidates[best][0]} as well: that would bring it to {share_words(ratios[best])} of this, more of it to "
                "less."
            )
        # The least effort first: the same sensors, and the first of the manoeuvres that help about as much.
        best = min(helping, key=lambda k: ratios[k])
        easy = next(k for k in helping if ratios[k] <= 1.5 * ratios[best])
        left = ratios[easy] * before * float(np.abs(unit).max())
        return f"{self._candidates[easy][0]} as well: that would bring it to about ±{share_words(left)}."

    @functools.cached_property
    def _candidates(self) -> list[tuple[str, np.ndarray]]:
        """The candidate trials in words, and their information in units of the size of the coefficients."""
        try:
            return list(self._worked_out())
        except ShipidError:
            return []

    def _worked_out(self) -> Iterator[tuple[str, np.ndarray]]:
        identified, problem = self._identified, self._identified.problem
        model, first = problem.model, problem.trials[0]
        length, unit_time = identified.ship.particular("L", "m"), identified.scale.unit_time
        if length is None or steered_by(model) is None:
            return
        speed = length / unit_time
        limit = identified.ship.particular("delta_max", "rad") or np.deg2rad(35.0)
        machine = {
            "delta_max": limit,
            "delta_rate": identified.ship.particular("delta_rate", "rad/s") or np.deg2rad(2.3),
        }
        known = {"tau_delta": 0.5} | machine | identified.values
        excess = identified.covariance.excess[: len(problem.estimated)]
        rate = 1 / first.step / max(1.0, float(np.mean(excess)))
        extra = tuple(s for s in SIGNALS if s in model and s not in problem.signals and is_predicted(model, s))
        level = dict(zip(problem.signals, problem.sigma.tolist()))
        level |= dict(zip(extra, 0.2 * structural_errors(extra, first, unit_time)))
        sizes = np.abs(self._size)

        def information(text: str, signals: tuple[str, ...], at: float) -> np.ndarray | None:
            initial, biases = generate(model).states_behind(signals), unknown_biases(model, signals)
            sigma = np.array([level[s] for s in signals])
            experiment = Experiment(model, length, problem.estimated, initial, biases, signals, sigma, rate, limit)
            manoeuvre = CandidateManoeuvre(parse_manoeuvre(text), at)
            found = experiment.information(manoeuvre, [30 * length / at], known, sizes)
            return None if found is None else np.asarray(found[-1])

        wanted = [(f"Sail a {_in_words(m)}", m, problem.signals, speed) for m in _MANOEUVRES]
        wanted = [w for w in wanted if parse_manoeuvre(w[1]).numbers[0] <= limit + 1e-9]
        if all(model[n].unit in ("", "1") for n in problem.estimated):
            slow = 0.6 * speed
            wanted.append((f"Sail a 20/20 zig-zag at {brief(slow, 2)} m/s", "zigzag:20/20", problem.signals, slow))
        for s in extra:
            words = f"Measure {SIGNAL_WORDS.get(s, s)} in a 20/20 zig-zag"
            wanted.append((words, "zigzag:20/20", (*problem.signals, s), speed))
        for words, text, signals, at in wanted:
            matrix = information(text, signals, at)
            if matrix is not None:
                yield words, matrix


def _in_words(text: str) -> str:
    kind, _, numbers = text.partition(":")
    return f"{numbers} zig-zag" if kind == "zigzag" else f"turning circle with {numbers} deg of rudder"
