"""The noise of the sensors in a simulated trial."""

from __future__ import annotations

from collections.abc import Mapping
from zlib import crc32

import numpy as np
import pandas as pd

from shipid.declaration.units import Typed, to_si
from shipid.declaration.vocabulary import FIELDS, shown
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.parts.sensors import LARGEST_LEVEL, SMALLEST_LEVEL, standard_noise

#: What a trial with sensors holds only where one of them measures it: speeds through the water, roll, shaft speed.
_ONLY_MEASURED = {"u", "v", "n", "phi", "p"}


def noise_words(deviations: Mapping[str, float], own: Mapping[str, str] | None = None) -> str:
    """Return the noise of a simulated trial in words: ``"psi 0.2 deg, r 0.02 deg/s"``, or ``"none"``.

    Parameters
    ----------
    deviations : mapping of str to float
        Standard deviations by column, SI.
    own : mapping of str to str, optional
        Units of columns outside the vocabulary, by name.
    """
    return ", ".join(f"{n} {shown(d, n, (own or {}).get(n, ''))}" for n, d in deviations.items()) or "none"


def parse_noise(text: str | Mapping[str, str | float] | None, own: Mapping[str, str] | None = None) -> dict[str, float]:
    """Read the noise of the sensors: ``"none"``, ``"standard"``, or ``"psi=0.2 deg,r=0.02 deg/s"``.

    Parameters
    ----------
    text : str, mapping or None
        As above, or standard deviations by column, with a unit or in SI.
    own : mapping of str to str, optional
        Units of the states of the model that are recorded where a sensor measures them, by name.

    Returns
    -------
    dict of str to float
        Standard deviation per sample by column, SI.

    Raises
    ------
    UsageError, UnitError, UnknownNameError
        If the text does not say a column and a value with a unit.
    """
    if text is None or text == "none":
        return {}
    if text == "standard":
        return standard_noise()
    pairs: Mapping[str, str | float]
    if isinstance(text, str):
        parts = [p.partition("=") for p in text.split(",")]
        if not all(sign and value.strip() for _, sign, value in parts):
            raise UsageError(
                f"the noise '{text}' is neither none nor standard nor a list such as psi=0.2 deg,r=0.02 deg/s."
            )
        pairs = {n.strip(): Typed(v) for n, _, v in parts}
    else:
        pairs = text
    units = {n: field.unit for n, field in FIELDS.items()} | dict(own or {})
    for name in pairs:
        if name not in units:
            raise UnknownNameError("column to put noise on called", name, units)
    deviations = {n: to_si(v, units[n], f"noise on {n}") if isinstance(v, str) else float(v) for n, v in pairs.items()}
    for name, deviation in deviations.items():
        if not 0 <= deviation < np.inf:
            raise UsageError(f"the noise on {name} is {pairs[name]}: a standard deviation is zero or more.")
        if 0 < deviation < SMALLEST_LEVEL:
            raise UsageError(
                f"the noise on {name} is {pairs[name]}, smaller than any sensor's. Give a standard deviation, or 0 for none."
            )
        if deviation > LARGEST_LEVEL:
            raise UsageError(f"the noise on {name} is {pairs[name]}, larger than any sensor's.")
    return deviations


def own_seed(seed: int, trial: str) -> int:
    """Return the seed of one trial: trials of one seed have noise that is not the same sample by sample.

    Whoever fits several trials together takes their noise for independent.

    Parameters
    ----------
    seed : int
        The seed that was stated.
    trial : str
        What tells the trial from others, such as the manoeuvre and its speed.
    """
    return int(np.random.SeedSequence([seed, crc32(trial.encode())]).generate_state(1)[0])


def measured(
    columns: Mapping[str, np.ndarray], t: np.ndarray, deviations: Mapping[str, float], seed: int
) -> pd.DataFrame:
    """Return what the sensors show of a simulated run.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (n,)
        The run.
    t : ndarray, shape (n,)
        Time [s].
    deviations : mapping of str to float
        Standard deviation per sample by column, SI; none, where the trial has no sensors.
    seed : int
        Of the noise.

    Returns
    -------
    pandas.DataFrame
        Column ``t``, and the others without a speed through the water, a shaft speed or a roll that no sensor measures.
    """
    rng = np.random.default_rng([seed, 0])
    table = {"t": t}
    unmeasured = _ONLY_MEASURED - set(deviations) if deviations else set()
    for name, column in columns.items():
        # Drawn for every column, so that the noise on one does not depend on which others carry noise.
        draw = rng.standard_normal(t.size)
        if name not in unmeasured:
            table[name] = column + deviations.get(name, 0.0) * draw
    return pd.DataFrame(table)
