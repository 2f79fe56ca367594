"""Manoeuvring criteria: a model evaluated against IMO MSC.137(76) 5.3, with its uncertainty.

A simulation is no trial: beyond the rudder angles of its trials a model extrapolates, and its numbers are no statement of an
Administration. The result says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from threadpoolctl import threadpool_limits

from shipid.criteria.criteria import (
    DEEP,
    NO_BAND,
    OPEN,
    WORDING,
    Criteria,
    Criterion,
    CriterionSide,
    first_overshoot_limit,
    loop_width_limit,
    second_overshoot_limit,
)
from shipid.criteria.spiral import Spiral, spiral_of
from shipid.criteria.standard_manoeuvres import KINDS, LENGTHS, ManoeuvreNumbers, StandardManoeuvres
from shipid.declaration.component import Component
from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import display_factor, display_unit, to_display
from shipid.estimation.standing import UNKNOWN
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ParameterSetError, UsageError
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, quantity
from shipid.identification.fit import Fit
from shipid.identification.uncertainty.draws import DRAWS, band_of, draws_of
from shipid.parameters.catalogue import model_of, ship_of
from shipid.parameters.draws import draw_coefficients
from shipid.parameters.parameter_set import ParameterSet, lacks_speed, missing_values
from shipid.parameters.validity import BEYOND, beyond, beyond_in_run
from shipid.parts.rudder_delay import not_steered, steered_by

#: Rudder rate where the ship's is unknown: from 35 deg on one side to 30 deg on the other in 28 s.
_RATE = np.deg2rad(65 / 28)
_TEN, _TWENTY, _FULL = np.deg2rad([10.0, 20.0, 35.0]).tolist()
#: The quantities of the standard, in the order of the table.
_KEYS = (
    "advance",
    "transfer",
    "tactical_diameter",
    "initial_turning",
    "first_overshoot_10",
    "second_overshoot_10",
    "first_overshoot_20",
)


def manoeuvring_criteria(
    model_or_fit: Model | type[Component] | Fit | str,
    ship: ParameterSet | str | None = None,
    *,
    speed: str | float | None = None,
    draws: int = DRAWS,
) -> Criteria:
    """Evaluate a model against IMO MSC.137(76) 5.3: turning, initial turning, yaw checking; and its spiral.

    Parameters
    ----------
    model_or_fit : Model, component class, Fit or str
        A fit, whose covariance makes the bands; or a model, with the standard deviations of the ship's own set.
    ship : ParameterSet or str, optional
        The ship; that of the fit by default.
    speed : str or float, optional
        Test speed, ``"15 kn"`` or in m/s; the ship's own by default.
    draws : int
        Number of parameter sets behind the bands; 0 for none.

    Returns
    -------
    Criteria

    Raises
    ------
    ParameterSetError
        If the ship lacks its length, its speed or a coefficient.
    UsageError
        If there is no ship, the speed is none, the model reads no rudder angle, or it reads an input that nothing states.
    UnknownNameError
        For a model or a ship that does not exist.
    """
    fit = model_or_fit if isinstance(model_or_fit, Fit) else None
    model = model_or_fit.model if isinstance(model_or_fit, Fit) else model_of(model_or_fit)
    if ship is None and fit is None:
        raise UsageError("criteria need a ship: its length, speed and coefficients.")
    own = fit.ship if fit is not None and ship is None else ship_of(ship)
    if steered_by(model) is None:
        raise UsageError(not_steered(model))
    if "psi" not in model or "x" not in model:
        raise UsageError(f"model {model.name} has no heading and track. Join it with PlanarMotion.")
    length, velocity = own.particular("L", "m"), _speed(own, speed)
    if length is None or length <= 0:
        raise ParameterSetError(f"ship {own.name} has no length L greater than zero, which the criteria are stated in.")
    known = own.values(model, speed=velocity) | (fit.identified.values if fit else {})
    lacking = missing_values(model, known, f"ship {own.name}")
    if lacking:
        raise lacking
    limit, rate = own.particular("delta_max", "rad"), own.particular("delta_rate", "rad/s")
    rudder = min(limit or _FULL, _FULL)
    steering = {"delta_max": limit or _FULL, "delta_rate": rate or _RATE}
    manoeuvres = StandardManoeuvres(model, velocity, length, rudder, steering)
    # The matrices are small: several threads on each cost more than they bring.
    with threadpool_limits(1, "blas"):
        sets, about = _sets(fit, model, own, known, draws)
        sides = [(manoeuvres(known, side), [manoeuvres(values, side) for values in sets]) for side in (1, -1)]
        spiral, *spirals = (spiral_of(model, values, velocity, length, limit or _FULL) for values in (known, *sets))
    notes: list[str] = _not_sailed(model, [point for point, _ in sides], rudder)
    notes += [*_scope(length, velocity, model), *(shallow := _shallow(known, own))]
    turned = [point.turned for point, _ in sides if point.turned]
    reached = {n: np.concatenate([one[n] for one in turned]) for n in (turned[0] if turned else ())}
    told = beyond_in_run(model, own, velocity, {**reached, "delta": np.array([rudder])})
    harder = _harder(model, own, rudder)
    notes += [*told, *_of_harder(harder), *([] if fit is None else _of_fit(fit))]
    if "u" not in model or model["u"].quantity.kind == "given":
        notes.append("The model keeps its speed in a turn: its distances are those of a ship without loss of speed.")
    if limit is None:
        notes.append("The largest rudder angle of the ship is unknown; 35 deg is assumed.")
    if rate is None:
        notes.append("The rudder rate of the ship is unknown; 65 deg in 28 s is assumed.")
    return Criteria(
        model.name,
        own.name,
        length,
        velocity,
        rudder,
        _rows(sides, length, length / velocity, not shallow, [_rudder_of(key, rudder) in harder for key in _KEYS]),
        _spiral(spiral, spirals, length / velocity, not shallow),
        (*notes, about),
    )


def _speed(ship: ParameterSet, speed: str | float | None) -> float:
    own = ship.particular("speed", "m/s")
    found = own if speed is None else to_si(speed, "m/s", "the speed") if isinstance(speed, str) else float(speed)
    if found is None:
        raise lacks_speed(ship, "--speed '15 kn'")
    if not 0 < found < np.inf:
        raise UsageError(f"a speed of {found:g} m/s is no test speed: give one greater than zero.")
    return found


def _sets(
    fit: Fit | None, model: Model, ship: ParameterSet, known: Mapping[str, float], count: int
) -> tuple[list[dict[str, float]], str]:
    """Parameter sets behind the bands, and where they come from in words."""
    if count <= 0:
        return [], "No bands were requested."
    if fit is not None:
        errors = fit.lacks.errors if fit.lacks is not None and fit.lacks.steering else None
        drawn = draws_of(fit.identified, count, errors=errors)
        sets = [{**known, **dict(zip(drawn.names, row.tolist()))} for row in drawn.values]
        # The bands of a predicted overshoot, in the same report, hold that as well, and are wider.
        without = "" if errors is not None else "; what the structure of the model is wrong by is not in them"
        return sets, f"Bands: 95 %, from the covariance of the identified coefficients{without}."
    drawn_set = draw_coefficients(model, ship, count)
    if not drawn_set.names:
        return [], f"No bands: {drawn_set.source}."
    sets = [{**known, **dict(zip(drawn_set.names, row.tolist()))} for row in drawn_set.values]
    return sets, f"Bands: 95 %, from {drawn_set.source}."


def _rows(
    sides: list[tuple[ManoeuvreNumbers, list[ManoeuvreNumbers]]],
    length: float,
    unit_time: float,
    judged: bool,
    harder: Sequence[bool],
) -> tuple[Criterion, ...]:
    angle, deg = display_unit("psi", "rad"), display_factor("psi", "rad")
    table = (
        ("advance", "advance", "L", 1 / length, 4.5, "4.5 L"),
        ("transfer", "transfer", "L", 1 / length, None, ""),
        ("tactical_diameter", "tactical diameter", "L", 1 / length, 5.0, "5 L"),
        ("initial_turning", "initial turning, 10 deg by 10 deg", "L", 1 / length, 2.5, "2.5 L"),
        ("first_overshoot_10", "10/10 first overshoot", angle, deg, first_overshoot_limit(unit_time), "10..20 deg by L/V"),
        ("second_overshoot_10", "10/10 second overshoot", angle, deg, second_overshoot_limit(unit_time), "25..40 deg by L/V"),
        ("first_overshoot_20", "20/20 first overshoot", angle, deg, 25.0, "25 deg"),
    )  # fmt: skip
    rows = []
    for (key, meaning, unit, scale, limit, text), extrapolated in zip(table, harder):
        found = []
        for point, drawn in sides:
            value = point.values[key]
            band = band_of(value, [d.values[key] for d in drawn])
            words = "" if value is not None else _why(key, point)
            if value is not None and band is None and drawn:
                words = NO_BAND
            scaled = None if band is None else (band[0] * scale, band[1] * scale)
            found.append(CriterionSide(None if value is None else value * scale, scaled, words))
        if "by L/V" in text and limit is not None:
            text = f"{brief(limit)} deg at L/V {brief(unit_time)} s"
        if not judged:
            limit, text = None, text and "in deep water only"
        rows.append(Criterion(key, meaning, unit, limit, text, found[0], found[1], extrapolated))
    return tuple(rows)


def _not_sailed(model: Model, points: Sequence[ManoeuvreNumbers], rudder: float) -> list[str]:
    """The manoeuvres that the model does not sail, with the reason, a sentence each."""
    lost = {kind: why for point in points for kind, why in point.lost.items()}
    names = {"turn": f"The turning circle at {to_display(rudder, 'delta'):g} deg"}
    return [
        Notice(
            f"{names.get(kind, f'The {kind} zig-zag')} is {NOT_SAILED} ({model.name}): {lost[kind]}. It has no numbers.",
            "not-sailed",
            serious=True,
            manoeuvre=kind,
        )
        for kind in KINDS
        if kind in lost
    ]


def _why(key: str, point: ManoeuvreNumbers) -> str:
    kind = "20/20" if key.endswith("_20") else "10/10" if key.endswith("_10") or key == "initial_turning" else "turn"
    if kind in point.lost:
        return f"{NOT_SAILED}: {point.lost[kind]}"
    return f"not reached: not within {LENGTHS[kind]:g} L/V of the order"


def _spiral(
    point: Spiral | None, drawn: Sequence[Spiral | None], unit_time: float, judged: bool
) -> dict[str, Plain] | None:
    if point is None:
        return None
    deg = display_factor("psi", "rad")
    limit = loop_width_limit(unit_time)
    found = band_of(point.half_width, [None if d is None else d.half_width for d in drawn])
    band = None if found is None else (max(0.0, found[0] * deg), found[1] * deg)
    wide, words = point.loop_width * deg, ""
    low, high = (wide, wide) if band is None else (2 * band[0], 2 * band[1])
    # As of every other value: not decided where the limit lies inside the band. A width of zero with a limit of zero is within.
    within = True if high <= limit else False if low > limit else None
    if not judged:
        within = None
    elif within is None:
        words = OPEN
    elif band is None and drawn:
        words = NO_BAND
    return {
        "stable": point.stable,
        "half_width": {
            **quantity(point.half_width * deg, "deg"),
            "interval_95": None if band is None else list(band),
        },
        "loop_width": {**quantity(wide, "deg"), "interval_95": None if band is None else [low, high]},
        "loop_height": quantity(None if point.loop_height is None else point.loop_height * deg, "deg/s"),
        "limit": quantity(limit, "deg"),
        "limit_text": f"limit of {brief(limit)} deg at L/V {brief(unit_time)} s (ascribed to the ABS guide of 2006, not verified)"
        if judged
        else "judged in deep water only",
        "within": within,
        "words": words,
    }


def _scope(length: float, speed: float, model: Model) -> list[str]:
    """The scope of the standard, and the conditions that the model cannot check."""
    notes = [
        f"Simulated by model {model.name} and {WORDING}; that is no statement of an Administration. The standard applies to "
        "ships of 100 m and longer, in deep water, calm, at full load and even keel."
    ]
    if length < 100:
        notes.append(f"This ship is {length:g} m long: the limits are shown for comparison only.")
    notes.append(
        f"The test speed of the standard is at least 90 % of the speed at 85 % of the engine's output; here it is "
        f"{brief(speed)} m/s, and the model has no engine to check it."
    )
    return notes


def _shallow(known: Mapping[str, float], ship: ParameterSet) -> list[str]:
    """That no value is judged, where the model feels the bottom: the limits are those of deep water."""
    depth, draught = known.get("depth"), ship.particular("T", "m")
    if depth is None or not draught or depth > DEEP * draught:
        return []
    words = f"The water is {brief(depth)} m deep, {brief(depth / draught)} draughts, and the standard holds in more than {DEEP:g}: no value is judged."
    return [Notice(words, "shallow-water", quantity="depth")]


def _rudder_of(key: str, rudder: float) -> float:
    """The rudder angle of the manoeuvre that a quantity is read from."""
    return _TWENTY if key.endswith("_20") else _TEN if key.endswith("_10") or key == "initial_turning" else rudder


def _harder(model: Model, ship: ParameterSet, rudder: float) -> list[float]:
    """The rudder angles of the criteria that are beyond those of the trials that the coefficients come from."""
    angles = sorted({_TEN, _TWENTY, rudder})
    return [a for a in angles if any(n.kind == BEYOND for n in beyond(model, ship, rudder=a))]


def _of_harder(harder: Sequence[float]) -> list[str]:
    """That the values at these rudder angles are extrapolated, in words."""
    named = " and ".join(f"{to_display(a, 'delta'):g}" for a in harder)
    words = f"The values for {named} deg of rudder are extrapolated."
    return [Notice(words, "extrapolated", quantity="delta")] if harder else []


def _of_fit(fit: Fit) -> list[str]:
    """What a fit says of its coefficients: those that the trials do not determine, and whether they are final."""
    notes: list[str] = []
    unknown = [n for n in fit.unidentifiable if fit.parameters[n].standing == UNKNOWN]
    if unknown:
        notes.append(
            f"The trials do not determine {', '.join(unknown)}: quantities that depend on them have a wide band, or none."
        )
    if not fit.converged:
        notes.append("The search did not converge: these are the numbers of an unfinished fit.")
    return notes
