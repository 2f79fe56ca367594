"""The sea that yaws a simulated ship: its usual frequency, and the white noise that drives the waves."""

from __future__ import annotations

import numpy as np

from shipid.declaration.model import Model

#: From this length on, in m, the sea is that of a ship at sea; for a smaller one it is scaled by Froude's law, as for a ship model.
FULL_LENGTH = 100.0
#: Frequency of the waves in rad/s for such a ship, and the damping ratio of the filter that makes waves of white noise.
FREQUENCY, DAMPING = 0.6, 0.15


def froude_share(length: float) -> float:
    """Return the square root of the length over 100 m, at most one: the scale of speeds, and the inverse of that of frequencies.

    Parameters
    ----------
    length : float
        Of the ship in m.
    """
    return float(np.sqrt(min(length, FULL_LENGTH) / FULL_LENGTH))


def driven_by(model: Model) -> tuple[str, str, float]:
    """Return how waves act on a simulated ship: a model with a moment by waves is moved, any other shows a yaw to its instruments.

    Parameters
    ----------
    model : Model
        A ship model.

    Returns
    -------
    name : str
        The input that white noise drives, of `shipid.parts.waves.WaveMoment` or of `shipid.parts.waves.Waves`.
    unit : str
        Of the size of the waves, SI: significant height, or root mean square of the heading, the ship at rest.
    share : float
        Root mean square of what is driven, over that size.
    """
    return ("elevation_noise", "m", 0.25) if "elevation_noise" in model.inputs else ("wave_noise", "rad", 1.0)


def wave_intensity(frequency: float, heading: float, damping: float = DAMPING) -> float:
    """Return the intensity of the white noise that drives `shipid.parts.waves.Waves`, in rad^2/s^3.

    Parameters
    ----------
    frequency : float
        Of the waves in rad/s.
    heading : float
        Root mean square of the heading by waves, the ship at rest, in rad.
    damping : float
        Damping ratio of the filter.
    """
    return 4 * damping * frequency**3 * heading**2


def wave_noise(
    count: int, interval: np.ndarray, seed: int, *, frequency: float, heading: float, damping: float = DAMPING
) -> np.ndarray:
    """Return the white noise that drives `shipid.parts.waves.Waves`, shape (count, runs), in rad/s^2.

    The variance of the heading by waves under noise of intensity q is q / (4 zeta omega^3).

    Parameters
    ----------
    count : int
        Steps.
    interval : ndarray, shape (runs,)
        Length of a step in s.
    seed : int
        Of the noise; every run has noise of its own.
    frequency : float
        Of the waves in rad/s.
    heading : float
        Root mean square of the heading by waves, the ship at rest, in rad.
    damping : float
        Damping ratio of the filter.
    """
    intensity = wave_intensity(frequency, heading, damping)
    draws = np.random.default_rng([seed, 7]).standard_normal((count, interval.size))
    return np.asarray(draws * np.sqrt(intensity / interval))
