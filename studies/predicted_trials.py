"""Predictions along real trials: from each execute on, by the identified model, beside what a bridge display can do without one.

For each campaign a model is identified on the fitted trials by the plain procedure (``identify --for prediction``) and predicts the
other runs, leg by leg: at each execute of a zig-zag or a turning circle the filter has run up to it and no later sample is read; the
order is the rudder angle that is put over then. Beside it stand the ground-speed vector, a constant rate of turn, and what a
production ECDIS does: rate of turn and speed with their accelerations, extrapolated about the pivot point. All start from one place.

The sailed track is the recorded one as far as it can be read: the integral of the recorded speeds, carried by the mean of the fixes
over four L/U. (Fixes of Gunnerus lag by up to 10 m for some seconds, and those of the pond jump by a tenth of a length.) Errors are
in ship lengths at equal time; the band is compared across the track. Horizons are times in which the ship sails so many lengths.

The trials are not part of the project; the script looks for them in ``../shared/data`` or ``--data``.

    python studies/predicted_trials.py [--data FOLDER] [--short] [--campaign NAME] [--legs] [--json]
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _table import Row, show

import shipid
from shipid.foundation.statistics import NORMAL_95
from shipid.prediction.following.past_predictions import situation_with_past
from shipid.prediction.predict_track import predict_track
from shipid.prediction.situations.situation import Situation
from shipid.trials.measuring.results.zigzag import ZigZag

FORMATS = Path(__file__).parent / "formats"
MARIN = "kvlcc2-marin/MARIN_FREE_KVLCC2_{}_m.dat"
HSVA = "kvlcc2-hsva/HSVA_CPMC_KVLCC2_Z_{}.dat"
GUNNERUS = "gunnerus/RVG_ManeuveringTests_part1.csv@{}"
ZIGZAG, TURN = "esso-osaka/zigzag_31-Jul-2020_{}", "esso-osaka/turn_14-Oct-2020_{}"
#: Horizons in ship lengths at the speed of the execute, and those at which the prediction has to be the best.
HORIZONS = np.array([0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0])
ASKED = HORIZONS > 0.5
#: Before the execute so many L/U are read for rates and accelerations, and fixes are averaged over so many on each side.
LOOK_BACK, CARRIED = 0.3, 2.0
WAYS = ("model", "vector", "rate", "ecdis")


@dataclass(frozen=True)
class Campaign:
    """A model, the trials it is fitted to, and those it predicts."""

    name: str
    model: str
    ship: str
    form: str
    fitted: tuple[str, ...]
    predicted: tuple[str, ...]


CAMPAIGNS = (
    Campaign(
        "KVLCC2, MARIN", "cross-flow", "kvlcc2", "kvlcc2-marin.toml",
        tuple(MARIN.format(n) for n in ("zz_20", "zz_-20")), tuple(MARIN.format(n) for n in ("zz_10", "tc_35")),
    ),
    Campaign(
        "KVLCC2, HSVA", "cross-flow", "kvlcc2-7m", "kvlcc2-hsva.toml",
        tuple(HSVA.format(n) for n in ("20_10_P", "20_10_S")),
        tuple(HSVA.format(n) for n in ("10_10_P", "35_05", "25_05", "15_05")),
    ),
    Campaign(
        "Gunnerus", "de-keizer-lag", "gunnerus", "gunnerus.toml",
        tuple(GUNNERUS.format(n) for n in ("1958:2195", "2690:2900")), (GUNNERUS.format("1500:1712"),),
    ),
    Campaign(
        "Esso Osaka", "cross-flow-wind", "esso-osaka-3m", "esso-osaka.toml",
        tuple(ZIGZAG.format(n) for n in (
            "13_04_24.csv@42.6:140", "13_14_21.csv@16.8:121", "13_42_53.csv@32:193", "14_03_39.csv@33.6:146",
        )),
        (ZIGZAG.format("13_29_19.csv@41:134"), *(TURN.format(n) for n in (
            "15_21_57.csv@70:350", "14_17_39.csv@150:320", "14_29_49.csv@80:300",
        ))),
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Leg:
    """One predicted leg: errors in ship lengths by way, shape (ways, horizons), distance across and heading in half-widths of the bands."""

    where: str
    errors: np.ndarray
    across: np.ndarray
    turned: np.ndarray


def executes(trial: shipid.Trial) -> list[tuple[float, float, float]]:
    """Return when the rudder is put over, when the leg ends, and the angle that is ordered."""
    found = shipid.measure(trial)
    times = list(found.executes) if isinstance(found, ZigZag) else [found.first_execute]
    t, delta = trial["t"], trial["delta"]
    ends = [*times[1:], float(t[-1])]
    # The ordered angle is the one the rudder reaches; by a third of a leg it has.
    return [
        (a, b, float(np.median(delta[(t > a + (b - a) / 3) & (t < b - 0.02 * (b - a))]))) for a, b in zip(times, ends)
    ]


def sailed(trial: shipid.Trial, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the sailed track: the integral of the recorded speeds, carried by fixes averaged over so many seconds on each side."""
    t, psi, u, v = (trial[n] for n in ("t", "psi", "u", "v"))
    half = max(1, round(seconds / float(np.median(np.diff(t)))))
    begin, end = np.maximum(np.arange(t.size) - half, 0), np.minimum(np.arange(t.size) + half + 1, t.size)
    found = []
    for fix, rate in (("x", u * np.cos(psi) - v * np.sin(psi)), ("y", u * np.sin(psi) + v * np.cos(psi))):
        run = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))])
        total = np.concatenate([[0.0], np.cumsum(trial[fix] - run)])
        found.append(run + (total[end] - total[begin]) / (end - begin))
    return found[0], found[1]


def extrapolated(
    times: np.ndarray, course: float, speed: float, rate: float = 0.0, turning: float = 0.0, slowing: float = 0.0
) -> np.ndarray:
    """Return displacements to the north and to the east, shape (times, 2), at a rate of turn and a speed that change evenly."""
    t = np.linspace(0.0, times[-1], 2000)
    angle, fast = course + rate * t + 0.5 * turning * t**2, np.maximum(speed + slowing * t, 0.0)
    steps = np.stack([fast * np.cos(angle), fast * np.sin(angle)], axis=1)
    whole = np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * (steps[1:] + steps[:-1]), axis=0) * t[1]])
    return np.stack([np.interp(times, t, column) for column in whole.T], axis=1)


def without_model(trial: shipid.Trial, known: Situation, seconds: float, times: np.ndarray) -> list[np.ndarray]:
    """Return displacements by the ground-speed vector, by a constant rate of turn, and as an ECDIS extrapolates."""
    t = trial["t"]
    recent = (t <= known.t + 1e-9) & (t >= known.t - max(seconds, 4 * float(np.median(np.diff(t)))))
    since = t[recent] - known.t
    turning, rate = np.polyfit(since, trial["r"][recent], 1)
    slowing, _ = np.polyfit(since, np.hypot(trial["u"][recent], trial["v"][recent]), 1)
    north, east = known.ground_velocity
    course, speed = float(np.arctan2(east, north)), float(np.hypot(north, east))
    return [
        extrapolated(times, course, speed),
        extrapolated(times, course, speed, known.values["r"]),
        extrapolated(times, course, speed, rate, turning, slowing),
    ]


def legs_of(campaign: Campaign, folder: Path, runs: int | None) -> Iterator[Leg]:
    """Identify, and predict every leg of the other runs."""
    form = str(FORMATS / campaign.form)

    def read(name: str) -> shipid.Trial:
        return shipid.read_trial(str(folder / name), format=form)

    fit = shipid.identify(campaign.model, [read(n) for n in campaign.fitted], ship=campaign.ship, purpose="prediction")
    pilot = shipid.design_autopilot(campaign.model, fit.ship)
    for name in campaign.predicted[:runs]:
        trial = read(name)
        t, length = trial["t"], pilot.length
        for begin, end, order in executes(trial):
            if np.count_nonzero(t <= begin) < 12:
                continue
            known, _ = situation_with_past(pilot, trial, float(t[t <= begin][-1]))
            unit_time = length / known.values["u"]
            track = predict_track(pilot, known, rudder=order, horizon=float(HORIZONS[-1]) + 1).track
            times = HORIZONS * unit_time
            times = times[(times <= end - known.t) & (times <= track.t[-1])]
            if not times.size:
                continue
            north, east = sailed(trial, CARRIED * unit_time)
            truth = np.stack(
                [np.interp(known.t + times, t, z) - np.interp(known.t, t, z) for z in (north, east)], axis=1
            )
            at = track.at_time(times)
            ways = [np.stack([at["x"] - track.x[0], at["y"] - track.y[0]], axis=1)]
            ways += without_model(trial, known, LOOK_BACK * unit_time, times)
            away, node = track.distance_to(truth[:, 0] + track.x[0], truth[:, 1] + track.y[0])
            width = np.interp(node, np.arange(track.s.size), track.half_width)
            errors = np.full((len(WAYS), HORIZONS.size), np.nan)
            across, turned = np.full((2, HORIZONS.size), np.nan)
            errors[:, : times.size] = [np.hypot(*(w - truth).T) / length for w in ways]
            across[: times.size] = np.abs(away) / width
            headed = np.abs(np.interp(known.t + times, t, trial["psi"]) - at["psi"])
            turned[: times.size] = headed / (NORMAL_95 * np.interp(times, track.t, track.std["psi"]))
            yield Leg(f"{trial.name} at {begin:.4g} s, rudder {np.rad2deg(order):.0f} deg", errors, across, turned)


def rows_of(name: str, legs: list[Leg]) -> list[Row]:
    """The errors of a group of legs by horizon, and how often the band holds."""
    errors, across = np.stack([leg.errors for leg in legs]), np.stack([leg.across for leg in legs])
    counted = np.isfinite(across).sum(axis=0)
    seen = counted > 0
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        rms = np.sqrt(np.nanmean(errors**2, axis=0))
        held = np.nanmean(np.where(np.isnan(across), np.nan, across <= 1), axis=0)
    rows = []
    for k in np.flatnonzero(seen):
        best = bool((rms[0, k] < rms[1:, k]).all())
        others = ", ".join(f"{w} {v:.3f}" for w, v in zip(WAYS[1:], rms[1:, k]))
        rows.append(
            Row(
                f"{name}, {HORIZONS[k]:g} L, {counted[k]} legs",
                "the smallest error" if ASKED[k] else "shown only",
                f"{rms[0, k]:.3f} L ({others}); in the band {held[k]:.0%}",
                best or not ASKED[k],
            )
        )
    for what, off in (("track", across), ("heading", np.stack([leg.turned for leg in legs]))):
        share = float(np.mean(off[np.isfinite(off)] <= 1))
        rows.append(Row(f"{name}: {what} in the 95 % band, all horizons", "90 % or more", f"{share:.0%}", share >= 0.9))
    return rows


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "data")
    parser.add_argument("--short", action="store_true", help="the first predicted run of each campaign")
    parser.add_argument("--campaign", help="part of a name: only the campaigns that have it")
    parser.add_argument("--legs", action="store_true", help="print every leg")
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    if not chosen.data.is_dir():
        print(f"the trials are not at {chosen.data}; nothing was run (give --data).", file=sys.stderr)
        return 0
    everything, rows = [], []
    for campaign in (c for c in CAMPAIGNS if (chosen.campaign or "") in c.name):
        legs = list(legs_of(campaign, chosen.data, 1 if chosen.short else None))
        if chosen.legs:
            for leg in legs:
                shown = leg.across[np.isfinite(leg.across)].size
                print(
                    leg.where,
                    "error",
                    np.round(leg.errors[0, :shown], 3),
                    "half-widths",
                    np.round(leg.across[:shown], 1),
                )
        everything += legs
        rows += rows_of(campaign.name, legs)
    rows += rows_of("all campaigns", everything)
    show("Predictions along real trials, in ship lengths", rows, as_json=chosen.json)
    return 0


if __name__ == "__main__":
    sys.exit(main())
