"""The likelihood of a record as a function of coefficients, noise levels and biases, with its slopes."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from shipid.declaration.vocabulary import display_unit
from shipid.estimation.design import FilterDesign, FilterSettings, design_filter
from shipid.estimation.levels.ascent import Summit
from shipid.estimation.levels.bias_standings import is_steered
from shipid.estimation.levels.cleaned import cleaned, pieces, resolution
from shipid.estimation.levels.long_run import long_run_deviations
from shipid.estimation.levels.pieces import Piece
from shipid.estimation.records.arrangement import FilterRecord, arrange, columns_of
from shipid.estimation.settings.instruments import Amount
from shipid.estimation.settings.noise import times
from shipid.trials.speed import speed_before_in

#: A sensor is at most so many times better and worse than the level it starts from; noise of states likewise.
_BETTER, _WORSE, _LEAST, _MOST = 100.0, 300.0, 1e-3, 1e3
#: Prior standard deviation of the logarithm of a level: one of which the record says nothing stays where it starts.
_PRIOR = 3.0
#: Sensors are taken for so many times worse at first: from there the search finds its way more often.
_FIRST = 3.0
#: Prior standard deviations of biases: of a rudder [rad], and of the speed before the manoeuvre as a share of it.
_RUDDER, _SPEED, _CURRENT = np.deg2rad(5.0), 0.1, 1.0
#: Natural logarithm of the largest factor on a coefficient.
_REACH = 5.0
#: Step of a difference, in logarithms and in prior standard deviations of a bias.
_STEP = 1e-4


class Unknowns:
    """The likelihood of a record, with priors.

    Positive coefficients are unknowns by their logarithm, others in units of their first standard deviation; levels by their
    logarithm; biases of inputs in prior standard deviations.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    settings : FilterSettings
        What it was made of.
    record : Trial or mapping of str to ndarray
        What is filtered.
    kept : collection of str
        ``bias:INPUT`` that is none.

    Attributes
    ----------
    still : tuple of str
        The estimated coefficients that are constants.
    keys : tuple of str
        ``sensor:NAME`` and ``noise:NAME``.
    biases : tuple of str
        Inputs with a bias.
    bias_sizes : ndarray, shape (biases,)
        Prior standard deviations of the biases, SI.
    steered : bool
        Whether the rudder moves.
    declared : bool
        Whether the model itself is declared with noise on its states.
    middle, prior : ndarray, shape (unknowns,)
        What the filter has, and the standard deviations of the prior about it.
    """

    def __init__(
        self, design: FilterDesign, settings: FilterSettings, record: FilterRecord, kept: Collection[str] = ()
    ) -> None:
        self.design = design
        driven = {s.name for s in design.sources}
        walking = [n for n, state in design.parameters.items() if state in driven]
        self.still = tuple(n for n in design.parameters if n not in walking)
        self.declared = any(not s.assumed and s.name not in (settings.noise or {}) for s in design.sources)
        self.keys = (*(f"sensor:{n}" for n in design.measured), *(f"noise:{s.name}" for s in design.sources))
        self._fixed = design_filter(design.base, design.ship, self._with_constants(settings, walking))
        # What the record lacks is told in its own name, not in that of its pieces.
        arrange(design.instruments, record)
        columns = cleaned(design, record)
        self._pieces = [Piece(self._fixed, part) for part in pieces(columns)]
        first = design.first.parameters
        self._logs = np.array([design.parameters[n] != n for n in self.still], dtype=bool)
        self._origin = np.array([first[n][0] for n in self.still])
        own = np.array([design.first.deviations.get(n, first[n][1]) for n in self.still])
        self._size = np.where(self._logs, 1.0, np.where(own > 0, own, 1.0))
        sizes = {n: s for n, s in _biases(self._fixed, settings, columns).items() if f"bias:{n}" not in kept}
        self._moved = _moved(design, record, columns)
        self.steered = is_steered(columns)
        self.biases, self.bias_sizes = tuple(sizes), np.array(list(sizes.values()))
        positive = np.where(self._logs, np.abs(self._origin), 1.0)
        self.middle = np.concatenate(
            [np.log(positive), np.log(np.concatenate([design.r, design.q])), np.zeros(len(sizes))]
        )
        ones = np.ones(len(sizes))
        self.prior = np.concatenate(
            [own / np.where(self._logs, positive, self._size), np.full(len(self.keys), _PRIOR), ones]
        )
        steps = np.array([_resolution(design, columns, n) for n in design.measured])
        self._last: tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] | None = None
        self._finest = np.log(np.maximum(design.r / _BETTER, steps / np.sqrt(12)))

    def _with_constants(self, settings: FilterSettings, walking: list[str]) -> FilterSettings:
        """The settings of the same filter in which coefficients that do not change are constants."""

        def others(given: Mapping[str, Amount] | None) -> dict[str, Amount]:
            return {n: v for n, v in (given or {}).items() if n not in self.still}

        values = dict(settings.values or {}) | {n: self.design.first.parameters[n][0] for n in self.still}
        return replace(
            settings,
            values=values,
            estimated=walking,
            noise=others(settings.noise),
            start=others(settings.start),
            initial=others(settings.initial),
            gate=None,
            form="covariance",
            switchable=False,
            single=False,
        )

    @property
    def _parts(self) -> tuple[slice, slice, slice, slice]:
        """Coefficients, sensors, noise, biases."""
        a, b, c = len(self.still), len(self.design.measured), len(self.design.sources)
        return slice(0, a), slice(a, a + b), slice(a + b, a + b + c), slice(a + b + c, None)

    def start(self) -> np.ndarray:
        """Return where the search begins."""
        z = self.middle.copy()
        z[self._parts[1]] += np.log(_FIRST)
        return z

    def bounds(self, learnt: Collection[str]) -> tuple[np.ndarray, np.ndarray]:
        """Return the bounds of the unknowns, shapes (unknowns,); levels that are not learnt stay.

        A filter of which every level was given runs as it was given, without biases.

        Parameters
        ----------
        learnt : collection of str
            Keys of the levels that are.
        """
        low, high = self.middle.copy(), self.middle.copy()
        still, sensors, noise, biases = self._parts
        low[still], high[still] = self.middle[still] - _REACH, self.middle[still] + _REACH
        low[sensors], high[sensors] = np.minimum(self._finest, high[sensors]), high[sensors] + np.log(_WORSE)
        low[noise], high[noise] = low[noise] + np.log(_LEAST), high[noise] + np.log(_MOST)
        if learnt:
            low[biases], high[biases] = -4.0, 4.0
        held = np.array(
            [*(False for _ in self.still), *(k not in learnt for k in self.keys), *(False for _ in self.biases)]
        )
        low[held] = high[held] = self.middle[held]
        return low, high

    def without_noise(self, at: np.ndarray, share: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return start and bounds of a search in which nothing drives the ship, and all sensors' levels are free.

        Parameters
        ----------
        at : ndarray, shape (unknowns,)
            Where coefficients and biases start.
        share : float
            Factor on the noise of states that makes it vanish.
        """
        _, sensors, noise, _ = self._parts
        low, high = self.bounds([k for k in self.keys if k.startswith("sensor:")])
        low[noise] = high[noise] = self.middle[noise] + np.log(share)
        start = at.copy()
        start[sensors] = self.middle[sensors] + np.log(_FIRST)
        return start, low, high

    def coefficients(self, z: np.ndarray) -> np.ndarray:
        """Return the coefficients, SI, shape (coefficients,).

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The unknowns.
        """
        own = z[self._parts[0]]
        return np.asarray(np.where(self._logs, np.exp(np.where(self._logs, own, 0.0)), self._origin + self._size * own))

    def sizes(self, z: np.ndarray) -> np.ndarray:
        """Return the derivative of the coefficients by their unknowns, shape (coefficients,).

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The unknowns.
        """
        return np.asarray(np.where(self._logs, self.coefficients(z), self._size))

    def levels(self, z: np.ndarray) -> dict[str, float]:
        """Return the noise levels, SI, by key.

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The unknowns.
        """
        _, sensors, noise, _ = self._parts
        return dict(zip(self.keys, np.exp(z[sensors.start : noise.stop]).tolist()))

    def bias(self, z: np.ndarray) -> dict[str, float]:
        """Return the biases, SI, by input: what is added to the inputs of the record as it is.

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The unknowns.
        """
        return {n: b + self._moved.get(n, 0.0) for n, b in self._own_bias(z).items()}

    def _own_bias(self, z: np.ndarray) -> dict[str, float]:
        """What is added to the inputs of the record without its wild samples."""
        return dict(zip(self.biases, (z[self._parts[3]] * self.bias_sizes).tolist()))

    def units(self) -> dict[str, tuple[str, str]]:
        """Return the unit of each level, and the one it is shown in, by key."""
        return {k: _units_of(self.design, k) for k in (*self.keys, *(f"bias:{n}" for n in self.biases))}

    def _innovations(self, z: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """The innovations, their variances and which there are, piece by piece; those of the last point are kept."""
        if self._last is None or not np.array_equal(self._last[0], z):
            self._last = z.copy(), self._run(z)
        return self._last[1]

    def _run(self, z: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        layout, system = self._fixed.layout, self._fixed.system
        constants = self._fixed.constants.copy()
        for name, value in zip(self.still, self.coefficients(z)):
            constants[layout.constants["p"].start + system.coefficients.index(name)] = value
        _, sensors, noise, _ = self._parts
        constants[layout.constants["r"]], constants[layout.constants["q"]] = np.exp(z[sensors]), np.exp(z[noise])
        shift = np.zeros(layout.inputs)
        for name, value in self._own_bias(z).items():
            shift[self._fixed.model.inputs.index(name)] = value
        return [piece.innovations(constants, shift) for piece in self._pieces]

    def value(self, z: np.ndarray) -> float:
        """Return the logarithm of likelihood and prior; minus infinity where the filter diverges.

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The unknowns.
        """
        value = -0.5 * float(np.sum(((z - self.middle) / self.prior) ** 2))
        with np.errstate(all="ignore"):
            for e, s, there in self._innovations(z):
                value -= 0.5 * float(np.sum((np.log(s) + e**2 / s)[there]))
        return value if np.isfinite(value) else -np.inf

    def leave_out(self, z: np.ndarray, width: float, most: float) -> int:
        """Return how many samples are left out from now on: those beyond a gate, where they are few.

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The unknowns.
        width : float
            Standard deviations.
        most : float
            Largest share of a sensor's samples: more are rarely wrong.

        Returns
        -------
        int
        """
        found = self._innovations(z)
        beyond = [there & (e**2 > width**2 * s) for e, s, there in found]
        shares = sum(b.sum(axis=0) for b in beyond) / np.maximum(sum(there.sum(axis=0) for _, _, there in found), 1)
        for piece, wild in zip(self._pieces, beyond):
            piece.leave_out(wild & (shares <= most))
        self._last = None
        return int(sum((b & (shares <= most)).sum() for b in beyond))

    def slopes(self, z: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return gradient and expected information, shapes (unknowns,) and (unknowns, unknowns).

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The unknowns.
        free : ndarray of bool, shape (unknowns,)
            By which of them; the others have zeros.
        """
        scores, information = self._scores(z, free)
        off = np.where(free, (z - self.middle) / self.prior**2, 0.0)
        return scores.sum(axis=0) - off, information + np.diag(np.where(free, 1 / self.prior**2, 0.0))

    def _scores(self, z: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivative of the log-likelihood of each row, shape (rows, unknowns), and Fisher's information of all."""
        base, index = self._innovations(z), np.flatnonzero(free)
        # Unknown by unknown in one run of memory: with the unknowns last every difference would be written all over it.
        slopes = [np.empty((index.size, 2, *e.shape)) for e, _, _ in base]
        for j, i in enumerate(index):
            nudged = z.copy()
            nudged[i] += _STEP
            for slope, (e, s, _), (e_0, s_0, _) in zip(slopes, self._run(nudged), base):
                np.subtract(e, e_0, out=slope[j, 0])
                np.subtract(s, s_0, out=slope[j, 1])
        information = np.zeros((z.size, z.size))
        scores = np.zeros((sum(len(e) for e, _, _ in base), z.size))
        row = 0
        for slope, (e, s, there) in zip(slopes, base):
            one = np.where(there, 1 / s, 0.0)
            root = np.sqrt(one)
            # Mean and variance of each innovation, the first in its standard deviations, the second as a share of itself, over root 2.
            slope[:, 0] *= root / _STEP
            slope[:, 1] *= one / (_STEP * np.sqrt(2))
            flat = slope.reshape(index.size, 2 * e.size)
            information[np.ix_(index, index)] += flat @ flat.T
            off = np.stack([-e * root, np.sqrt(0.5) * (e**2 * one - there)])
            scores[row : row + len(e), index] = np.einsum("kmrs,mrs->rk", slope, off)
            row += len(e)
        return scores, information

    def deviations(self, summit: Summit) -> tuple[np.ndarray, np.ndarray]:
        """Return standard deviations of coefficients and biases: by the information, and under the innovations as they are.

        Parameters
        ----------
        summit : Summit
            The maximum.

        Returns
        -------
        white, correlated : ndarray, shape (coefficients + biases,)
            In the unknowns; the second is larger where the innovations are correlated (Huber 1967; White 1982). Biases that were
            not sought have zero.
        """
        levels = slice(self._parts[1].start, self._parts[2].stop)
        seen = summit.free.copy()
        seen[levels] = False
        index = np.flatnonzero(seen)
        inverse = np.linalg.pinv(summit.information[np.ix_(index, index)])
        scores, _ = self._scores(summit.at, seen)
        white, correlated = np.zeros(summit.at.size), np.zeros(summit.at.size)
        white[index] = np.sqrt(np.diag(inverse))
        correlated[index] = long_run_deviations(scores[:, index], inverse)
        still, _, _, biases = self._parts
        return np.r_[white[still], white[biases]], np.r_[correlated[still], correlated[biases]]


def _biases(design: FilterDesign, settings: FilterSettings, columns: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Inputs that have a constant bias in a record, as in its identification, and how large it is likely to be, SI."""
    shown = {design.instruments.quantity_of(n) for n in design.measured}
    speed = np.nanmax(np.abs(columns["cruise"])) if "cruise" in columns else 0.0
    sizes = {"delta": _RUDDER}
    if "u" in shown and speed > 0:
        sizes["cruise"] = _SPEED * float(speed)
    if {"x", "y"} & shown:
        sizes |= {"current_north": _CURRENT, "current_east": _CURRENT}
    given, read = settings.inputs or {}, design.instruments.needed
    return {n: s for n, s in sizes.items() if n in design.model.inputs and n in read and n not in given}


def _moved(design: FilterDesign, record: FilterRecord, columns: Mapping[str, np.ndarray]) -> dict[str, float]:
    """The speed before the manoeuvre without wild samples, less the one with them."""
    raw, _ = columns_of(record)
    before = speed_before_in(raw, design.instruments.scale.unit_time)
    if before is None or "cruise" in raw or "cruise" not in columns:
        return {}
    return {"cruise": float(columns["cruise"][0]) - before.value}


def _resolution(design: FilterDesign, columns: Mapping[str, np.ndarray], sensor: str) -> float:
    column = design.instruments.column_of(sensor, columns)
    return 0.0 if column is None else resolution(columns[column])


def _units_of(design: FilterDesign, key: str) -> tuple[str, str]:
    """The unit of a level, and the one it is shown in."""
    kind, _, name = key.partition(":")
    own = design.model[name].unit
    quantity = design.model[name].quantity.measures or name
    units = (own, display_unit(quantity, own))
    source = next((s for s in design.sources if kind == "noise" and s.name == name), None)
    if source is None or not source.density:
        return units
    root = "s^0.5" if source.place == "input" else "1/s^0.5"
    return times(units[0], root), times(units[1], root)
