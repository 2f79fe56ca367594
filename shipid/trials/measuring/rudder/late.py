"""A rudder that sets out later than its order is stamped: by its ramp, or, where it is not logged, by the ship's answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.declaration.vocabulary import angle, shown
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.trials.doctor.early_rudder import early_rudder, order_answered
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.rudder.answer import answer_of_turn
from shipid.trials.measuring.rudder.executes import first_execute, leaves
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.signals.channel import Channel
from shipid.trials.signals.order import GEAR, lag_behind_order
from shipid.trials.trial import Trial

_SEEN = 0.3
"""A rudder that sets out this much later than the order is seen to do so [s]."""

_ABOUT = 0.15
"""Share of a delay within which the doctor finds it."""

_UNSEEN = np.radians(0.3)
"""Heading that is turned in a time that does not show, from which on it is said."""


@dataclass(frozen=True)
class SettingOut:
    """When the rudder sets out after the orders, where that is later than the stamps of the orders allow.

    Attributes
    ----------
    times : tuple of float
        When it sets out after each order [s].
    doubtful : bool
        Whether no steering gear starts so late: then the stamps are early, or the gear has a dead time, and which is not known.
    words : str
        What to say of it.
    kind, channel : str
        Of the finding that it is.
    about : float
        By which share of the time between them it may be wrong.
    """

    times: tuple[float, ...]
    doubtful: bool
    words: str
    kind: str = "order-early"
    channel: str = "delta_order"
    about: float = 0.0

    def notice(self, beside: str) -> Notice:
        """Return what to say of it.

        Parameters
        ----------
        beside : str
            What is measured from there.
        """
        sign = f"{self.kind} ({self.channel}): " if self.doubtful else ""
        return Notice(f"{sign}{self.words}; {beside}", self.kind, serious=self.doubtful, channel=self.channel)


def setting_out(trial: Trial, steering: Steering, orders: Sequence[float], faults: Faults) -> SettingOut | None:
    """Return when the rudder sets out after the orders; None where it does so at once, or where that is not known.

    Where the orders are read from the rudder, and the doctor finds that the ship answers it too late or too early, the clocks are
    apart by so much.

    Parameters
    ----------
    trial : Trial
        The trial.
    steering : Steering
        The record of the rudder.
    orders : sequence of float
        When the orders were given [s].
    faults : Faults
        What the doctor found.
    """
    if steering.reading != "order" or not len(orders):
        return None
    if steering.feedback is None:
        return _by_answer(trial, steering, orders) if steering.rate is None else _by_clock(trial, orders, faults)
    lag = lag_behind_order(trial["t"], trial["delta_order"], trial["delta"])
    slack = 0.5 * steering.channel.interval
    if lag is None or lag - slack < _SEEN:
        return None
    return SettingOut(
        _seen(steering, orders, lag), lag - slack > GEAR,
        f"the rudder sets out {brief(lag, 3)} s after the order: {_either(lag - slack > GEAR)}",
    )  # fmt: skip


def _by_answer(trial: Trial, steering: Steering, orders: Sequence[float]) -> SettingOut | None:
    """When a rudder sets out that is not logged, by the ship's answer to its order."""
    answer = order_answered(trial, steering.channel.name)
    if answer is None or answer.earliest <= 0 or answer.delay < _SEEN:
        return None
    doubtful = answer.delay - 0.5 * steering.channel.interval > GEAR
    return SettingOut(
        tuple(when + answer.delay for when in orders), doubtful,
        f"the rudder angle is not logged, and by the ship's answer it sets out {brief(answer.delay, 3)} s after the order "
        f"({brief(answer.earliest, 2)} to {brief(answer.latest, 2)} s): {_either(doubtful)}", about=_ABOUT,
    )  # fmt: skip


def _by_clock(trial: Trial, orders: Sequence[float], faults: Faults) -> SettingOut | None:
    """When a rudder acts whose clock is not that of the heading: in both readings the overshoot is counted from there."""
    found = next((f for f in faults.diagnosis.serious if f.kind == "latency" and f.channel == "delta"), None)
    if found is None:
        return None
    early = early_rudder(trial) if found.fix is None else None
    apart = float(found.fix["seconds"]) if found.fix is not None else None if early is None else early.seconds
    if apart is None:
        return None
    return SettingOut(tuple(when + apart for when in orders), True, found.message, found.kind, found.channel, _ABOUT)


def _either(doubtful: bool) -> str:
    if doubtful:
        return "the gear has a dead time, or the order is stamped early, and which is not known"
    return "as a steering gear may, or the order is stamped early"


def _seen(steering: Steering, orders: Sequence[float], lag: float) -> tuple[float, ...]:
    """When the rudder leaves its plate after each order, by its ramp; `lag` later where that does not show."""
    rudder = steering.feedback
    usual = np.asarray(orders) + lag
    if rudder is None or len(steering.answers) < 2:
        return tuple(float(when) for when in usual)
    seen = np.array([leaves(rudder, plate).time for plate in steering.answers[:-1]])
    nearest = seen[np.abs(usual[:, None] - seen).argmin(axis=1)]
    return tuple(float(a) for a in np.where(np.abs(nearest - usual) < 0.5 * lag, nearest, usual))


def turn_setting_out(steering: Steering, side: int, order: float) -> SettingOut | None:
    """Return when the rudder sets out after the order of a turn, by its ramp; None where it does so at once, or is not logged.

    Parameters
    ----------
    steering : Steering
        The record of the order, with that of the rudder beside it.
    side : int
        1 for a turn to starboard, -1 for one to port.
    order : float
        When the order was given [s].
    """
    rudder = steering.feedback
    slack = 0.5 * steering.channel.interval
    if rudder is None or steering.reading != "order":
        return None
    seen = [first_execute(rudder, plate) for plate in steering.answers if plate.side == side]
    after = [found[0].time for found in seen if found is not None and found[0].time > order]
    if not after or min(after) - order - slack < _SEEN:
        return None
    lag = min(after) - order
    return SettingOut(
        (min(after),),
        lag - slack > GEAR,
        f"the rudder sets out {brief(lag, 3)} s after the order: {_either(lag - slack > GEAR)}",
    )


def turn_by_clock(steering: Steering, psi: Channel, side: int, moves: float) -> SettingOut | None:
    """Return when the rudder of a turn acts by the ship's answer, where its clock is not that of the heading; None where it is.

    Parameters
    ----------
    steering : Steering
        The record of the rudder, or of the order with that of the rudder beside it.
    psi : Channel
        The heading.
    side : int
        1 for a turn to starboard, -1 for one to port.
    moves : float
        When the rudder sets out by its stamps [s].
    """
    rudder = steering.feedback or steering
    answer = answer_of_turn(rudder.channel, psi, side, moves)
    # An order alone is answered late: the gear takes its time.
    if answer is None or not answer.apart or (rudder.logged and answer.delay > 0):
        return None
    span = f"{brief(abs(answer.delay), 2)} s {'after' if answer.delay > 0 else 'before'} the rudder moves (to {brief(answer.within, 2)} s)"
    why = "are not on one clock" + (", or the steering gear has a dead time" if answer.delay > 0 else "")
    words = f"by its stamps the ship begins to turn {span}: rudder and heading {why}"
    return SettingOut((moves + answer.delay,), True, words, "latency", rudder.channel.name)


def turn_notes(
    late: SettingOut | None, beside: Mapping[str, float | None], steering: Steering, speed: float
) -> list[Notice]:
    """Return what to say of a turn whose rudder sets out after its order, or is not logged.

    Parameters
    ----------
    late : SettingOut or None
        When it sets out.
    beside : Mapping of str to float or None
        The distances counted from there, by their names [m].
    steering : Steering
        The record of the rudder.
    speed : float
        Speed at the order [m/s].
    """
    if late is not None:
        return [late.notice(f"counted from there: {in_words(beside)}")]
    if not steering.logged or steering.feedback is not None:
        return []
    return [
        Notice(
            "the order is logged and no rudder angle beside it: stamps that are early would not show, and every second makes the "
            f"advance {shown(speed, 'x', digits=2)} too large",
            "order-alone",
        )
    ]


def in_words(found: Mapping[str, float | None]) -> str:
    """Return the distances of a turn in words, those that are known.

    Parameters
    ----------
    found : Mapping of str to float or None
        The distances by their names [m].
    """
    return ", ".join(f"{n.replace('_', ' ')} {shown(v, 'x', digits=3)}" for n, v in found.items() if v is not None)


def unseen_by(trial: Trial, steering: Steering) -> float | None:
    """Return by how much the stamps of an order with no rudder angle beside it may be early without a word [s].

    Parameters
    ----------
    trial : Trial
        The trial.
    steering : Steering
        The record of the rudder.
    """
    if not steering.logged or steering.feedback is not None or steering.reading != "order":
        return None
    answer = order_answered(trial, steering.channel.name)
    return np.inf if answer is None else max(answer.latest, 0.0)


def widened(
    uncertainties: Sequence[float | None],
    overshoots: Sequence[float | None],
    beside: Sequence[float | None],
    about: float,
) -> tuple[float | None, ...]:
    """Return uncertainties that hold both readings of the execute, where it is not known which is right [rad].

    Parameters
    ----------
    uncertainties, overshoots, beside : sequence of float or None
        Of the overshoots, the overshoots from the order, and those from where the rudder sets out [rad].
    about : float
        By which share of their distance the last ones may be wrong.
    """
    return tuple(
        u if u is None or one is None or other is None else u + (1 + about) * abs(one - other)
        for u, one, other in zip(uncertainties, overshoots, beside)
    )


def late_notes(
    late: SettingOut | None, beside: Sequence[float | None] | None, unseen: float | None, turning: float
) -> list[Notice]:
    """Return what to say of a rudder that sets out after its order, or that is not logged.

    Parameters
    ----------
    late : SettingOut or None
        When it sets out.
    beside : sequence of float or None, or None
        The overshoots counted from there [rad].
    unseen : float or None
        By how much the stamps of an order alone may be early without a word [s].
    turning : float
        Usual rate of turn at the orders [rad/s].
    """
    if late is not None:
        said = ", ".join("not known" if beyond is None else f"{np.degrees(beyond):.1f}" for beyond in beside or ())
        return [late.notice(f"counted from there the overshoots are {said} deg")]
    if unseen is None or min(unseen, GEAR) * turning < _UNSEEN:
        return []
    seconds = "stamps that are early" if np.isinf(unseen) else f"stamps that are up to {brief(unseen, 2)} s early"
    return [
        Notice(
            f"the order is logged and no rudder angle beside it: {seconds} would not show, and every second makes the overshoots "
            f"{angle(turning, 2)} too large",
            "order-alone",
        )
    ]


def not_told(notes: Sequence[Notice], late: SettingOut | None, channel: str) -> list[Notice]:
    """Return what the doctor says without what is told of the order already.

    Parameters
    ----------
    notes : sequence of Notice
        What the doctor says.
    late : SettingOut or None
        When the rudder sets out.
    channel : str
        The column of the order.
    """
    told = ("order-early", "latency")
    return [n for n in notes if late is None or n.kind not in told or n.known.get("channel") != channel]
