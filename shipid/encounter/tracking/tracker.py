"""From detections to tracks: integrated probabilistic data association around multiple-model filters.

Each track has a probability that its target exists, and one that each sensor has it in sight (Musicki, Evans and Stankovic, 1994;
Musicki and Suvorova, 2008). A plot that no track explains begins a track; a track is confirmed when its existence is nearly
sure, lost when it is not any longer, and forgotten when it is improbable.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.plots.plots import Plots, Scan, Sensor
from shipid.encounter.tracking.association import joint_probabilities, nearest_assignment
from shipid.encounter.tracking.clutter import ClutterMap
from shipid.encounter.tracking.filters.alpha_beta_filters import AlphaBetaFilters
from shipid.encounter.tracking.filters.target_filters import TargetFilters
from shipid.encounter.tracking.latency import Latency
from shipid.encounter.tracking.sensor_bias import SensorBias
from shipid.encounter.tracking.track_residuals import TrackResiduals

#: Existence is never certain: a sure track could not be lost.
_SURE = 1 - 1e-6
#: Existence above which a track explains a plot to the map of false ones.
_EXPLAINS = 0.99


@dataclass(frozen=True)
class TrackerSettings:
    """What decides on tracks.

    Attributes
    ----------
    association : {"joint", "nearest"}
        Joint probabilities of all pairs, or the nearest assignment.
    gate : float
        Squared distance in standard deviations beyond which a plot is not a target's; 13.8 leaves 0.1 % out.
    births : float
        New targets expected in a scan, over all that a sensor covers.
    survival : float
        Mean time a target stays, s.
    out_of_sight : float
        Mean time after which a sensor may see a hidden target again, s.
    confirmed, lost, forgotten : float
        Existence at which a track is confirmed, told to be lost, and dropped.
    patience : float
        Time after its last plot at which a lost track ends, s.
    plots_to_confirm : int
        Plots a track needs before it is confirmed.
    speed : float
        Standard deviation of the velocity of a new target along each axis, m/s.
    same : float
        Two tracks nearer than so many standard deviations, squared, are one target.
    """

    association: Literal["joint", "nearest"] = "joint"
    gate: float = 13.8
    births: float = 1.2
    survival: float = 120.0
    out_of_sight: float = 60.0
    confirmed: float = 0.999
    lost: float = 0.5
    forgotten: float = 0.002
    patience: float = 45.0
    plots_to_confirm: int = 3
    speed: float = 3.5
    same: float = 2.0

    def __post_init__(self) -> None:
        """Refuse settings that cannot be meant."""
        if self.association not in ("joint", "nearest"):
            raise EncounterRequestError(f"'{self.association}' is no association. Write joint or nearest.")
        if not 0 < self.forgotten < self.lost < self.confirmed < 1:
            raise EncounterRequestError("the existence of a track that is forgotten, lost and confirmed has to rise.")
        positive = (self.gate, self.births, self.survival, self.out_of_sight, self.speed, self.same, self.patience)
        if not all(np.isfinite(p) and p > 0 for p in positive) or self.plots_to_confirm < 1:
            raise EncounterRequestError("every setting of a tracker has to be a number above zero.")


@dataclass(frozen=True, eq=False)
class Standing:
    """The tracks after a scan.

    Attributes
    ----------
    t : float
        s.
    sensor : int
        Which sensor looked.
    number : ndarray, shape (n,)
        Of each track.
    x : ndarray, shape (n, 4)
        North and east position and velocity.
    P : ndarray, shape (n, 4, 4)
        Covariance, widened, with the offsets that the sensors may have.
    widening : ndarray, shape (n,)
        Factor of the covariance: how far the residuals of the track contradict what its filter says; one where they do not.
    mu : ndarray, shape (n, modes)
        MotionMode probabilities.
    turn_rate : ndarray, shape (n,)
        rad/s.
    existence : ndarray, shape (n,)
        Probability.
    confirmed : ndarray of bool, shape (n,)
        Whether the track has ever been confirmed.
    seen : ndarray of bool, shape (n,)
        Whether a plot of this scan is more likely its own than not.
    """

    t: float
    sensor: int
    number: np.ndarray
    x: np.ndarray
    P: np.ndarray
    widening: np.ndarray
    mu: np.ndarray
    turn_rate: np.ndarray
    existence: np.ndarray
    confirmed: np.ndarray
    seen: np.ndarray


@dataclass
class Tracker:
    """Tracks of all targets, scan by scan.

    Attributes
    ----------
    filters : TargetFilters or AlphaBetaFilters
        The filters of no target yet; they say how targets may move.
    sensors : sequence of Sensor
        The sensors, by index.
    settings : TrackerSettings
        What decides on tracks.
    """

    filters: TargetFilters | AlphaBetaFilters
    sensors: tuple[Sensor, ...]
    settings: TrackerSettings = field(default_factory=TrackerSettings)

    def __post_init__(self) -> None:
        """Begin without a track."""
        self.existence = np.zeros(0)
        self.in_sight = np.zeros((0, len(self.sensors)))
        self.number = np.zeros(0, int)
        self.plots = np.zeros(0, int)
        self.confirmed = np.zeros(0, bool)
        self.last = np.zeros(0)
        self.clutter = [ClutterMap() for _ in self.sensors]
        self.latency = [Latency(s.latency, s.latency_std) for s in self.sensors]
        self.residuals = TrackResiduals(len(self.sensors))
        self.bias = SensorBias(self.sensors)
        self._t: float | None = None
        self._next = 1

    def run(self, plots: Plots) -> list[Standing]:
        """Return the tracks after each scan of a log.

        Parameters
        ----------
        plots : Plots
            In the order of time.
        """
        return [self.update(scan) for scan in plots]

    def update(self, scan: Scan) -> Standing:
        """Take in a scan.

        Parameters
        ----------
        scan : Scan
            The next one.

        Returns
        -------
        Standing
        """
        rules, k = self.settings, scan.sensor
        sensor, map_ = self.sensors[k], self.clutter[k]
        self._pass(max(scan.t - (scan.t if self._t is None else self._t), 0.0))
        self._t = scan.t if self._t is None else max(self._t, scan.t)
        own = np.broadcast_to(scan.own, scan.z.shape)
        R = sensor.covariance(scan.z, own)
        delay = scan.ago + self.latency[k].value
        width = np.sqrt(0.5 * np.trace(R, axis1=1, axis2=2))
        map_.cover(scan.z, scan.own, width)
        density = map_.density(scan.z, width)
        expected = self.filters.expect(scan.z, R, delay)
        chance = sensor.detection * self.in_sight[:, k]
        missed = 1 - self.existence * chance
        likelihood = (self.filters.mu[:, :, None] * expected.density).sum(axis=1)
        inside = expected.distance.min(axis=1, initial=np.inf) < rules.gate
        weights = np.where(inside, (self.existence * chance / missed)[:, None] * likelihood / density, 0.0)
        association = joint_probabilities if rules.association == "joint" else nearest_assignment
        pairs = association(weights)
        none, pair = pairs[:, 0], pairs[:, 1:]
        exists = pair.sum(axis=1) + none * self.existence * (1 - chance) / missed
        shares = (
            np.concatenate([(exists - pair.sum(axis=1))[:, None], pair], axis=1) / np.maximum(exists, 1e-300)[:, None]
        )
        found = 1 - shares[:, 0]
        held = self.confirmed & (self.existence > rules.lost)
        self.latency[k].learn(self.filters, expected, shares, held)
        self.residuals.learn(k, self.filters.mu, expected, shares, held)
        before = self.filters.combined()[1] if self.bias.known else None
        self.filters = self.filters.update(expected, delay, shares)
        if before is not None:
            self.bias.learn(k, scan, before, self.filters.combined()[1])
        unseen = self.in_sight[:, k] * (1 - sensor.detection) / np.maximum(1 - chance, 1e-12)
        self.in_sight[:, k] = np.clip(found + (1 - found) * unseen, 1e-3, 1 - 1e-3)
        self.existence = np.minimum(exists, _SURE)
        # A ship at anchor would else become a part of the map of false plots before her track is confirmed.
        sure = self.existence > _EXPLAINS
        self.plots = self.plots + (found > 0.5)
        seen = found > 0.5
        self.last = np.where(seen, self._t, self.last)
        free = np.clip(1 - pair.sum(axis=0), 0.0, 1.0)
        map_.learn(scan.z, scan.own, free, np.clip(1 - pair[sure].sum(axis=0), 0.0, 1.0))
        new = free > 0.5
        self._begin(scan, k, new, R, delay, free * rules.births / (rules.births + density * map_.area))
        seen = np.concatenate([seen, np.ones(int(new.sum()), bool)])
        inside = ~map_.cut_off(self.filters.combined()[0][:, :2], scan.own)
        proven = (self.existence > rules.confirmed) & (self.plots >= rules.plots_to_confirm)
        self.confirmed = self.confirmed | (seen & inside & proven)
        keep = self._kept()
        self._select(keep)
        x, P = self.filters.combined()
        wider = self.residuals.widening
        P = wider[:, None, None] * P
        if self.bias.known:
            P = P + self.bias.covariance(x)
        return Standing(
            self._t, k, self.number.copy(), x, P, wider, self.filters.mode_shares.copy(), self.filters.turn_rates(),
            self.existence.copy(), self.confirmed.copy(), seen[keep],
        )  # fmt: skip

    def _pass(self, interval: float) -> None:
        """Let time pass."""
        rules = self.settings
        self.filters = self.filters.predict(interval)
        self.existence = self.existence * np.exp(-interval / rules.survival)
        usual = np.array([s.sight for s in self.sensors])
        self.in_sight = usual + (self.in_sight - usual) * np.exp(-interval / rules.out_of_sight)

    def _begin(
        self, scan: Scan, k: int, new: np.ndarray, R: np.ndarray, delay: np.ndarray, existence: np.ndarray
    ) -> None:
        """Begin a track with each plot that no track explains."""
        count = int(new.sum())
        self.filters = self.filters.begin(scan.z[new], R[new], delay[new], self.settings.speed)
        self.existence = np.concatenate([self.existence, existence[new]])
        sight = np.tile([s.sight for s in self.sensors], (count, 1))
        self.in_sight = np.concatenate([self.in_sight, sight])
        self.number = np.concatenate([self.number, self._next + np.arange(count)])
        self.plots = np.concatenate([self.plots, np.ones(count, int)])
        self.confirmed = np.concatenate([self.confirmed, np.zeros(count, bool)])
        self.last = np.concatenate([self.last, np.full(count, scan.t)])
        self.residuals.begin(count)
        self.bias.begin(k, count)
        self._next += count

    def _kept(self) -> np.ndarray:
        """Which tracks go on: those that may exist, and one of two that are the same target."""
        rules = self.settings
        keep = self.existence > rules.forgotten
        # A lost track coasts on: the longer, the more likely it takes the plots of another target.
        assert self._t is not None, "called after a scan"
        keep &= ~self.confirmed | (self.existence > rules.lost) | (self._t - self.last < rules.patience)
        x, P = self.filters.combined()
        held = self.confirmed & (self.existence > rules.lost)
        # Of two that are one target the first by this order stays: held, then by existence, then by age.
        order = np.lexsort((np.arange(len(x)), -self.existence, ~held))
        i, j = (order[side] for side in np.triu_indices(len(x), 1))
        apart = x[i] - x[j]
        # The sharper one says how near they are: one that has seen nothing for long is so wide that it lies on every new one.
        size = P[:, 0, 0] + P[:, 1, 1]
        sharper = np.where(size[i] <= size[j], i, j)
        # Only neighbours are looked at in full.
        near = np.hypot(apart[:, 0], apart[:, 1]) ** 2 < 2 * rules.same * size[sharper]
        i, j, apart, sharper = i[near], j[near], apart[near], sharper[near]
        distance = np.einsum("ki,ki->k", apart, np.linalg.solve(2 * P[sharper], apart[..., None])[..., 0])
        for one, other in zip(i[distance < rules.same], j[distance < rules.same]):
            # A lost track may find its target again: only one that is held takes its place.
            if keep[one] and (held[one] or not self.confirmed[other]):
                keep[other] = False
        return np.asarray(keep)

    def _select(self, keep: np.ndarray) -> None:
        self.filters = self.filters.select(keep)
        self.residuals.select(keep)
        self.bias.select(keep)
        for name in ("existence", "in_sight", "number", "plots", "confirmed", "last"):
            setattr(self, name, getattr(self, name)[keep])
