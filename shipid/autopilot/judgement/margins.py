"""Margins of the loop, broken at the rudder order: gain, phase, delay, disk, sensitivity peaks, bandwidth.

python-control gives gain and phase; disk margins are computed here for any number of loops at once, by the same formula
(Seiler, Packard and Gahinet 2020, "An introduction to disk margins", with skew 0), as the covariance needs thousands.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.autopilot.design.placement import Gains
from shipid.autopilot.design.plant import Plant
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import with_units
from shipid.foundation.result import ResultEntry
from shipid.foundation.statistics import plain

if TYPE_CHECKING:
    import control

#: Range of frequencies, in u/L: from a turn of a thousand lengths to the lag of any servo.
_FREQUENCIES = np.geomspace(1e-3, 1e3, 481)
#: Points of the refined grid, between the neighbours of the peak on the first grid.
_CLOSER = 41


@dataclass(frozen=True, repr=False)
class Margins(ResultEntry):
    """Margins at one speed.

    Attributes
    ----------
    speed : float
        In m/s.
    gain : float or None
        Factor of the loop gain nearest to one at which the loop is on the edge; None where there is none.
    gain_low, gain_high : float or None
        The largest below one, for a ship that is unstable by itself, and the smallest above one.
    phase_deg : float or None
        Phase margin in degrees.
    delay_s : float or None
        Delay in s at which the loop is on the edge.
    disk : float
        Disk margin: gain by (2 + d)/(2 - d) and phase by 2 atan(d/2) at once; 2 is the most there is, 0 is unstable.
    bandwidth : float or None
        Frequency in rad/s at which the heading follows its order by 0.707.
    sensitivity, complementary : float
        Peaks of the sensitivity and of the complementary sensitivity.
    """

    UNITS: ClassVar[Mapping[str, str]] = {
        "speed": "m/s",
        "bandwidth": "rad/s",
        "gain": "1",
        "gain_low": "1",
        "gain_high": "1",
        "disk": "1",
        "sensitivity": "1",
        "complementary": "1",
    }

    speed: float
    gain: float | None
    gain_low: float | None
    gain_high: float | None
    phase_deg: float | None
    delay_s: float | None
    disk: float
    bandwidth: float | None
    sensitivity: float
    complementary: float

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return with_units(asdict(self), speed="m/s", bandwidth="rad/s")


def loop_polynomials(plant: Plant, gains: dict[str, np.ndarray] | Gains) -> tuple[np.ndarray, np.ndarray]:
    """Return numerator and denominator of the loop, each of shape (..., k), highest power first.

    Parameters
    ----------
    plant : Plant
        From the rudder order, its steering machine inside its limits included.
    gains : Gains or dict of str to ndarray
        The law; arrays have the shape of the conditions.
    """
    table = {n: np.asarray(getattr(gains, n)) for n in ("Kp", "Kd", "Ki")} if isinstance(gains, Gains) else gains
    heading, rate = plant.numerators[..., 0, :], plant.numerators[..., 1, :]
    numerator = table["Kp"][..., None] * heading + table["Kd"][..., None] * rate
    zero = np.zeros((*numerator.shape[:-1], 1))
    integral = table.get("Ki")
    if integral is None or not np.any(integral):
        return np.concatenate([zero, numerator], axis=-1), plant.denominator
    numerator = np.concatenate([zero, numerator, zero], axis=-1)
    numerator[..., 2:] += integral[..., None] * heading
    return numerator, np.concatenate([plant.denominator, zero], axis=-1)


def sea_filtered(
    numerator: np.ndarray, denominator: np.ndarray, frequency: np.ndarray, width: float, corner: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return loops with the sea filter in them: ``(s^2 + omega^2) / (s^2 + 2 zeta omega s + omega^2) * c / (s + c)``.

    Parameters
    ----------
    numerator, denominator : ndarray, shape (..., k)
        Of the loops.
    frequency : ndarray, shape (...)
        Of the notch in rad/s.
    width : float
        Its damping ratio.
    corner : ndarray, shape (...)
        Corner frequency c of the lag in rad/s.
    """
    one, zero = np.ones_like(frequency), np.zeros_like(frequency)
    top = np.stack([corner, zero, corner * frequency**2], axis=-1)
    bottom = np.stack([one, 2 * width * frequency, frequency**2], axis=-1)
    lag = np.stack([one, corner], axis=-1)
    # A leading zero: numerator and denominator keep one length.
    top = np.concatenate([zero[..., None], top], axis=-1)
    return _times(numerator, top), _times(_times(denominator, bottom), lag)


def _times(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    product = np.zeros((*a.shape[:-1], a.shape[-1] + b.shape[-1] - 1))
    for k in range(b.shape[-1]):
        product[..., k : k + a.shape[-1]] += a * b[..., [k]]
    return product


def disk_margins(numerator: np.ndarray, denominator: np.ndarray, pace: np.ndarray | float) -> np.ndarray:
    """Return the disk margins of many loops; 0 where a loop is unstable.

    Parameters
    ----------
    numerator, denominator : ndarray, shape (..., k)
        Of the loops.
    pace : ndarray or float
        u/L in 1/s of each, by which the frequencies are scaled.
    """
    pace = np.broadcast_to(np.asarray(pace, dtype=float), numerator.shape[:-1])
    omega = pace[..., None] * _FREQUENCIES
    first = disk_on(numerator, denominator, omega)
    index = np.clip(first.argmin(axis=-1), 1, len(_FREQUENCIES) - 2)
    low, high = np.log(_FREQUENCIES[index - 1]), np.log(_FREQUENCIES[index + 1])
    closer = np.exp(low[..., None] + (high - low)[..., None] * np.linspace(0, 1, _CLOSER)) * pace[..., None]
    found = np.minimum(first.min(axis=-1), disk_on(numerator, denominator, closer).min(axis=-1))
    return np.where(growth(numerator + denominator) < 0, found, 0.0)


def disk_on(numerator: np.ndarray, denominator: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Return ``2 / |S - T|`` at each frequency: its least value is the disk margin of a stable loop.

    Parameters
    ----------
    numerator, denominator : ndarray, shape (..., k)
        Of the loops.
    omega : ndarray, shape (..., f)
        In rad/s.
    """
    s = 1j * omega
    top, bottom = _at(denominator - numerator, s), _at(denominator + numerator, s)
    return np.asarray(2 * np.abs(bottom) / np.maximum(np.abs(top), 1e-300))


def growth(polynomial: np.ndarray) -> np.ndarray:
    """Return the largest real part of the roots of many polynomials.

    Parameters
    ----------
    polynomial : ndarray, shape (..., k)
        Highest power first; the first one is not zero.
    """
    n = polynomial.shape[-1] - 1
    companion = np.zeros((*polynomial.shape[:-1], n, n))
    companion[..., 0, :] = -polynomial[..., 1:] / polynomial[..., :1]
    companion[..., np.arange(1, n), np.arange(n - 1)] = 1.0
    return np.asarray(np.linalg.eigvals(companion).real.max(axis=-1))


def _at(polynomial: np.ndarray, s: np.ndarray) -> np.ndarray:
    value = np.zeros(s.shape, dtype=complex)
    for k in range(polynomial.shape[-1]):
        value = value * s + polynomial[..., k, None]
    return value


def to_transfer_function(plant: Plant, gains: Gains) -> control.TransferFunction:
    """Return the loop of one plant as a python-control transfer function.

    Parameters
    ----------
    plant : Plant
        One condition, from the rudder order.
    gains : Gains
        The law.
    """
    import control

    numerator, denominator = loop_polynomials(plant, gains)
    return control.tf(np.trim_zeros(numerator, "f"), denominator)


def margins_at(plant: Plant, gains: Gains, speed: float, pace: float) -> Margins:
    """Return the margins of one loop.

    Parameters
    ----------
    plant : Plant
        One condition, from the rudder order.
    gains : Gains
        The law.
    speed : float
        In m/s.
    pace : float
        u/L in 1/s.
    """
    import control

    loop = to_transfer_function(plant, gains)
    gains_all, phases, _, _, crossings, _ = control.stability_margins(loop, returnall=True)
    gain, phase, *_ = control.stability_margins(loop)
    factors = np.asarray(gains_all, dtype=float)
    below, above = factors[(factors > 0) & (factors < 1)], factors[factors > 1]
    phases, crossings = np.asarray(phases, dtype=float), np.asarray(crossings, dtype=float)
    delays = np.deg2rad(np.mod(phases, 360.0)) / crossings if crossings.size else np.array([np.inf])
    numerator, denominator = loop_polynomials(plant, gains)
    omega = pace * np.geomspace(1e-3, 1e3, 4001)
    top, bottom = _at(numerator, 1j * omega), _at(numerator + denominator, 1j * omega)
    sensitivity = np.abs(bottom - top) / np.abs(bottom)
    following = np.abs(_order_to_heading(plant, gains, 1j * omega))
    return Margins(
        speed=float(speed),
        gain=plain(gain),
        gain_low=plain(below.max() if below.size else None),
        gain_high=plain(above.min() if above.size else None),
        phase_deg=plain(phase),
        delay_s=plain(delays.min()),
        disk=float(disk_margins(numerator, denominator, pace)),
        bandwidth=_bandwidth(omega, following),
        sensitivity=float(sensitivity.max()),
        complementary=float(np.abs(top / bottom).max()),
    )


def _order_to_heading(plant: Plant, gains: Gains, s: np.ndarray) -> np.ndarray:
    """From the ordered heading to the heading; the rate of turn is fed back and not ordered."""
    numerator, denominator = loop_polynomials(plant, gains)
    heading = plant.numerators[0]
    ordered = gains.Kp * heading if gains.Ki == 0 else np.polymul(heading, [gains.Kp, gains.Ki])
    return np.asarray(_at(ordered, s) / _at(numerator + denominator, s))


def _bandwidth(omega: np.ndarray, size: np.ndarray) -> float | None:
    below = np.flatnonzero(size < np.sqrt(0.5))
    if not below.size or below[0] == 0:
        return None
    k = int(below[0])
    # Straight between two points in logarithms, as the curve is there.
    a, b = np.log(size[k - 1 : k + 1])
    share = (np.log(np.sqrt(0.5)) - a) / (b - a)
    return float(np.exp(np.log(omega[k - 1]) + share * np.log(omega[k] / omega[k - 1])))
