"""The result of a recursion over a record: parameters along it, their standard deviations, and whether it diverged."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.fft import next_fast_len

from shipid.declaration.units import pretty
from shipid.estimation.estimate import Estimate, estimate_of
from shipid.estimation.records.arrangement import Arrangement
from shipid.estimation.records.consistency import whiteness
from shipid.estimation.records.triangles import unpacked
from shipid.estimation.standing import UNKNOWN
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import brief, moment, percent, probability, quantity
from shipid.foundation.result import DrawnResult
from shipid.foundation.statistics import WHITE
from shipid.identification.recursive.design import RecursiveDesign
from shipid.identification.recursive.recursion import FEW

if TYPE_CHECKING:
    import pandas as pd

#: A recursion has diverged where, in the last quarter of the record, innovations are so many times as large as expected, and their
#: excess power is such a share of the variance of the motion. A slightly wrong model meets only the first condition.
_LARGE, _UNEXPLAINED = 1.4, 0.1
#: A widening below this is within the scatter for white innovations.
_WORTH_SAYING = 1.25
#: The fields of an estimate that are reported as plain values.
_REPORTED = ("value", "unit", "std", "interval_95", "identifiable", "standing", "why", "follows", "meaning")


@dataclass(frozen=True, eq=False, repr=False)
class RecursiveIdentification(DrawnResult):
    """A record and the result of the recursion; N samples, n parameters.

    Attributes
    ----------
    design : RecursiveDesign
        Which recursion.
    record : str
        Name of the record.
    arranged : Arrangement
        The record as the recursion took it.
    noise_level : float
        Standard deviation of a sample of the measured state, given or found in the record, SI.
    out : ndarray, shape (rows, outputs)
        What the recursion returned for each row (`RecursionLayout.outputs`).
    """

    design: RecursiveDesign
    record: str
    arranged: Arrangement
    noise_level: float
    out: np.ndarray

    def _rows(self, name: str) -> np.ndarray:
        return np.asarray(self.out[self.arranged.shown][:, self.design.layout.outputs[name]])

    @property
    def names(self) -> tuple[str, ...]:
        """The estimated parameters."""
        return self.design.names

    @property
    def t(self) -> np.ndarray:
        """Times of the samples in s, shape (N,)."""
        return np.asarray(self.arranged.t[self.arranged.shown])

    @property
    def theta(self) -> np.ndarray:
        """Estimates of the parameters after each sample, SI, shape (N, n)."""
        return self._rows("theta")

    @property
    def y(self) -> np.ndarray:
        """Estimate of the measured state after each sample, SI, shape (N,)."""
        return self._rows("y")[:, 0]

    @functools.cached_property
    def noise_ratio(self) -> np.ndarray:
        """Size of the innovations so far over that expected: 1 where the noise level is right; shape (N,).

        The intervals of methods that do not use the noise level are scaled by it.
        """
        ratio = self._rows("nis")[:, 0] / np.maximum(self._rows("count")[:, 0], 1.0)
        return np.sqrt(np.where(self._rows("count")[:, 0] < FEW * len(self.names), 1.0, ratio))

    @functools.cached_property
    def covariance(self) -> np.ndarray:
        """Covariance of the parameters after each sample, SI, shape (N, n, n), under the gains that were used.

        It counts the scatter by noise and by the unknown start. The bias of a method that has one is not in it.
        """
        joint = unpacked(self._rows("joint"), len(self.names) + 1)[:, 1:, 1:]
        return joint if self.design.method.uses_noise_level else joint * self.noise_ratio[:, None, None] ** 2

    @property
    def std(self) -> np.ndarray:
        """Standard deviations of the parameters after each sample, SI, shape (N, n)."""
        return np.asarray(np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=1, axis2=2), 0.0)))

    @property
    def innovations(self) -> np.ndarray:
        """What was measured less what was predicted, SI, shape (N,); NaN where nothing was measured."""
        return np.where(self._taken, self._rows("e")[:, 0], np.nan)

    @property
    def innovation_variances(self) -> np.ndarray:
        """Their variances by the gains and the noise level, SI, shape (N,)."""
        return self._rows("S")[:, 0]

    @property
    def _taken(self) -> np.ndarray:
        there: np.ndarray = self.arranged.there[self.arranged.shown, 0].copy()
        if self.design.starts_at_sample and there.any():
            there[int(np.argmax(there))] = False
        return there

    @functools.cached_property
    def _normalised(self) -> np.ndarray:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray((self._rows("e")[:, 0] / np.sqrt(self._rows("S")[:, 0]))[self._taken])

    @property
    def nis_mean(self) -> float | None:
        """Mean of the squared innovations, each over its variance: 1 where the recursion is consistent."""
        mean = float(np.mean(self._normalised**2)) if self._normalised.size else np.nan
        return mean if np.isfinite(mean) else None

    @property
    def white_p(self) -> float | None:
        """Probability of correlations as large as these if the innovations were white (Ljung-Box)."""
        p = whiteness(self._normalised) if np.isfinite(self._normalised).all() else None
        return p if p is not None and np.isfinite(p) else None

    @property
    def _excess(self) -> tuple[float, float]:
        """Size of the last innovations over that expected, and their excess power as a share of the motion's variance."""
        last = slice(-max(1, self._normalised.size // 4), None)
        e, spread, z = (
            a[self._taken][last] for a in (self._rows("e")[:, 0], self.innovation_variances, self._measured)
        )
        power = float(np.mean(e**2 - spread)) / max(float(np.var(z)), float(np.finfo(float).tiny))
        return float(np.sqrt(np.mean(self._normalised[last] ** 2))), power

    @property
    def _measured(self) -> np.ndarray:
        z: np.ndarray = self.arranged.z[self.arranged.shown, 0]
        return z

    @functools.cached_property
    def why_diverged(self) -> str:
        """Why the last estimate is not reliable; empty where it is."""
        if not np.isfinite(self._rows("theta")).all() or not np.isfinite(self._rows("S")).all():
            lost = ~np.isfinite(self._rows("theta")).all(axis=1) | ~np.isfinite(self._rows("S")[:, 0])
            return f"the estimates diverge {moment(self.t[int(np.argmax(lost))])} s into the record."
        model, scale = self.design.model, self.design.instruments.scale
        for i, name in enumerate(self.names):
            value, (low, high) = float(self.theta[-1, i]), scale.bounds_of(model[name])
            if not low <= value <= high:
                unit = pretty(model[name].unit)
                return f"'{name}' ends at {brief(value, 4)} {unit}, outside the bounds it is declared with."
        if self._normalised.size < FEW:
            return ""
        size, share = self._excess
        if size > _LARGE and share > _UNEXPLAINED:
            return (
                f"at the end the innovations are {brief(size, 3)} times as large as expected, and their excess power is "
                f"{percent(share)} of the motion's variance: the recursion has diverged. Start it closer to the true values, with "
                "another first standard deviation (start, initial), or with noise on the parameters (noise)."
            )
        return ""

    @property
    def diverged(self) -> bool:
        """Whether the recursion diverged; `why_diverged` gives the reason."""
        return bool(self.why_diverged)

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """What makes the estimates unusable, what their intervals leave out, and whether the innovations are not white."""
        if self.diverged:
            return (Notice(f"not reliable: {self.why_diverged}", "diverged", serious=True),)
        method, output = self.design.method, self.design.output
        found = (
            f"Noise in the measured {output} biases the estimates of {method.name}, by some percent or more; the intervals hold their "
            "scatter, and not this bias. Without it: --method instrumental-variables, or ekf."
        )
        biased = (Notice(found, "biased", sensor=output),) if method.is_biased else ()
        p = self.white_p
        if p is None or p >= WHITE:
            return biased
        words = f"The innovations are not white (p {probability(p)}): the model does not explain part of them."
        return (*biased, Notice(words, "innovations-not-white", sensor=output, p_value=p))

    @functools.cached_property
    def follow(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Published coefficients that follow along the record: values and standard deviations, SI, each of shape (N,)."""
        return self.design.published_along(self.theta, np.nan_to_num(self.covariance))

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the estimates of a parameter, or of a published coefficient that follows, along the record, SI."""
        if name in self.names:
            return self.theta[:, self.names.index(name)]
        return self._following(name)[0]

    def std_of(self, name: str) -> np.ndarray:
        """Return standard deviations along the record, SI, shape (N,).

        Parameters
        ----------
        name : str
            A parameter, or a published coefficient that follows from them.
        """
        return self.std[:, self.names.index(name)] if name in self.names else self._following(name)[1]

    def _following(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        if name not in self.follow:
            raise UnknownNameError("estimated parameter", name, [*self.names, *self.follow])
        return self.follow[name]

    @functools.cached_property
    def widening(self) -> float:
        """Factor on the last intervals, 1 or more: for innovations larger than expected, or correlated in time.

        The error of a slightly wrong model lasts for many samples, which are then not independent. The factor is the
        root of the innovations' power over that expected, times the length of their correlation. It is a rough figure: how much
        correlated noise disturbs a parameter depends on its spectrum.
        """
        method, count = self.design.method, self._normalised.size
        late = self._normalised[count // 4 :]
        if method.instruments:
            # The auxiliary model is run without measurements: it shows slow errors that the one-step error does not.
            late = self._rows("e_aux")[self._taken, 0][3 * count // 4 :] / self.noise_level
        if late.size < 4 * FEW or not np.isfinite(late).all():
            return 1.0
        power = float(np.mean(late**2)) if method.uses_noise_level or method.instruments else 1.0
        if method.instruments:
            power /= float(self.noise_ratio[-1]) ** 2
        return float(np.sqrt(max(1.0, power * correlation_length(late))))

    @functools.cached_property
    def parameters(self) -> dict[str, Estimate]:
        """The last estimate of each parameter, and of what follows from them, with 95 % intervals that are widened (`widening`)."""
        return {
            name: estimate_of(
                self.design.model[name],
                float(self[name][-1]),
                float(self.std_of(name)[-1]) * self.widening,
                standing=(UNKNOWN, self.why_diverged) if self.diverged else None,
                follows=name not in self.names,
            )
            for name in (*self.names, *self.follow)
        }

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas table: time, estimates and standard deviations, SI, units in the headers."""
        import pandas as pd

        model, output = self.design.model, self.design.output
        columns: dict[str, np.ndarray] = {"t [s]": self.t, f"{output} [{model[output].unit}]": self.y}
        for name in (*self.names, *self.follow):
            unit = model[name].unit
            columns[f"{name} [{unit}]"] = self[name]
            columns[f"std_{name} [{unit}]"] = self.std_of(name)
        columns[f"innovation_{output} [{model[output].unit}]"] = self.innovations
        return pd.DataFrame(columns)

    def to_dict(self) -> dict[str, Plain]:
        """Return the result as plain values, free of NaN."""
        model, output = self.design.model, self.design.output
        return {
            "method": self.design.method.name,
            "model": model.name,
            "ship": self.design.ship.name,
            "record": self.record,
            "samples": int(self.t.size),
            "widening": self.widening,
            "diverged": self.diverged,
            "why": self.why_diverged,
            "parameters": {
                n: {key: value for key, value in p.to_dict().items() if key in _REPORTED}
                for n, p in self.parameters.items()
            },
            "noise": {output: quantity(self.noise_level, model[output].unit)},
            "innovations": {
                output: {
                    "nis_mean": self.nis_mean,
                    "white_p": self.white_p,
                    "rejected": 0,
                    "samples": int(self._normalised.size),
                }
            },
            "clock_went_back": self.arranged.back,
            "holes": self.arranged.to_dict(),
            "warnings": plain_notices(self.warnings),
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        lines = [
            f"{self.design!r}",
            f"record {self.record}: {self.t.size} samples, {moment(self.t[0])} to {moment(self.t[-1])} s",
        ]
        lines += [f"  {p}" for p in self.parameters.values()]
        mean = "-" if self.nis_mean is None else brief(self.nis_mean, 3)
        white = "-" if self.white_p is None else probability(self.white_p)
        lines.append(f"  innovations of {self.design.output}: NIS {mean} (1 is right), whiteness p {white}")
        lines += [f"  {sentence}" for sentence in self.arranged.words]
        if self.widening > _WORTH_SAYING:
            lines.append(
                f"  intervals are {brief(self.widening, 2)} times as wide as the noise level alone would make them: the innovations are "
                "larger than it, or not white"
            )
        if self.diverged:
            lines.append(f"  NOT RELIABLE: {self.why_diverged}")
        return "\n".join(lines)


def correlation_length(values: np.ndarray) -> float:
    """Return how many successive samples count as one, ``1 + 2 sum r_k`` up to the first correlation that is not positive.

    Parameters
    ----------
    values : ndarray, shape (N,)
        In the order of time.
    """
    centred = values - values.mean()
    # By the spectrum, padded so that the end does not meet the beginning: a day of samples has too many lags to sum one by one.
    size = next_fast_len(2 * values.size)
    r = np.fft.irfft(np.abs(np.fft.rfft(centred, size)) ** 2, size)[: values.size // 4 + 1]
    r = r[1:] / r[0] if r[0] > 0 else np.zeros(1)
    positive = np.flatnonzero(r <= 0)
    return float(1 + 2 * r[: int(positive[0]) if positive.size else r.size].sum())
