"""The range in which a ship's coefficients were found, and what is said where a command goes beyond it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import shown
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.parameters.catalogue import ADDED
from shipid.parameters.correlation import Joint
from shipid.parameters.parameter_set import ParameterSet

#: Share of a limit by which it may be passed without a word.
MARGIN = 0.1
#: The same of a loading, of which trials usually show two: as far as loadings are one.
_LOADED = 0.03
#: What the range says in one number: entry, words, field and unit.
_AMPLITUDES = (
    ("rudder", "rudder angles", "delta", "rad"),
    ("rate", "rates of turn", "r", "rad/s"),
    ("drift", "drift angles", "beta", "rad"),
)
#: Quantities beyond whose range a band grows.
_GROWS = ("delta", "r")
#: Kinds of the notices.
BEYOND, UNKNOWN, OTHERWISE, WRONG_SIGN = (
    "beyond-what-was-fitted",
    "range-not-known",
    "identified-otherwise",
    "wrong-sign",
)


def range_of(ship: ParameterSet, model: Model) -> tuple[str, Joint] | None:
    """Return the section of a ship's set that a model takes its coefficients from, and what is known of its origin.

    Parameters
    ----------
    ship : ParameterSet
        The ship.
    model : Model
        The model; its own section goes before those of the models it extends and of its components.
    """
    for section in model.known_as:
        if section in ship.joint:
            return section, ship.joint[section]
        # A table against speed is refused beyond its ends, and says so itself.
        tables = [v for v in ship.sections.get(section, {}).values() if v.speed]
        if tables:
            spans = [[to_si((s, v.speed_unit), "m/s", f"speed of '{v.name}'") for s in v.speed] for v in tables]
            return section, Joint((), (), (max(s[0] for s in spans), min(s[-1] for s in spans)))
    return None


def range_words(known: Joint) -> dict[str, str]:
    """Return the range that coefficients come from in words, by field: ``{"u": "5.2 to 8 m/s", "delta": "rudder angles up to 20 deg"}``.

    Parameters
    ----------
    known : Joint
        What a set says of the origin of its coefficients.
    """
    words = {} if known.speeds is None else {"u": speed_words(known.speeds)}
    for entry, what, name, unit in _AMPLITUDES:
        if (largest := getattr(known, entry)) is not None:
            words[name] = f"{what} up to {shown(largest, name, unit, digits=3)}"
    return words


def speed_words(span: tuple[float, float]) -> str:
    """Return a range of speeds in words: ``5.2 to 8 m/s``, or ``8 m/s`` where both ends are alike.

    Parameters
    ----------
    span : tuple of float
        Lowest and highest, in m/s.
    """
    low, high = (shown(v, "u", "m/s", digits=3) for v in span)
    return low if span[1] - span[0] < 0.005 * span[1] else f"{low.removesuffix(' m/s')} to {high}"


def beyond(
    model: Model,
    ship: ParameterSet,
    speeds: Sequence[float] = (),
    rudder: float | None = None,
    *,
    rate: float | None = None,
    drift: float | None = None,
    grown: float = 1.0,
    loading: Mapping[str, float] | None = None,
) -> list[Notice]:
    """Return what has to be said where a model is used beyond the range its coefficients come from.

    Parameters
    ----------
    model : Model
        What is run.
    ship : ParameterSet
        Whose coefficients.
    speeds : sequence of float
        The speeds before the manoeuvre in m/s. They are held against all the speeds that the trials went through: a ship that slows
        down from 8 m/s to 5 m/s has been tried at both.
    rudder, rate, drift : float, optional
        Largest rudder angle in rad, rate of turn in rad/s and drift angle in rad.
    grown : float
        How many times as large the error of the model is taken in the band that is shown, see `growth_beyond`; 1 where it is not.
    loading : mapping of str to float, optional
        ``draught`` in m or ``displacement`` in kg of a record; by default what the model holds it at (`hold_inputs`).

    Returns
    -------
    list of Notice
        One for each quantity that is beyond its range by more than a tenth, rudder angle and rate of turn in one; one that says
        which range is not known, where
        the set does not state it; none for a model that takes no coefficient from the ship.
    """
    if all(ship.find(model, n) is None for n in (*model.parameters, *model.derived)):
        return []  # it takes no coefficient from the ship
    found = range_of(ship, model)
    known = None if found is None else found[1]
    unstated = _unstated(known, rudder is not None)
    notices = [*_signs(model, ship), *_identified_otherwise(model, ship)]
    if unstated:
        notices.append(
            Notice(
                f"The range of {' and '.join(unstated)} that the coefficients of model {model.name} come from is not known: "
                f"ship {ship.name} does not state it.",
                UNKNOWN,
            )
        )
    if found is None or known is None:
        return notices
    section, words = found[0], range_words(known)
    tells = (
        f"the band takes its error as {brief(grown, 2)} times as large as there."
        if grown > 1
        else "no band contains that error."
    )

    def say(*amplitudes: tuple[str, float, str, str]) -> None:
        """One notice: its quantity is the first, and what goes beyond with it is named beside it."""
        name, *others = (a[2] for a in amplitudes)
        also: dict[str, Plain] = {"also": others} if others else {}
        goes = " and ".join(f"{what} {shown(value, n, unit, digits=3)}" for what, value, n, unit in amplitudes)
        notices.append(
            Notice(
                f"{goes[0].upper()}{goes[1:]}: the [{section}] coefficients of ship {ship.name} were found at "
                f"{' and '.join(words[n] for n in (name, *others))}. "
                f"Beyond that the model extrapolates, and {tells if name in _GROWS else 'no band contains that error.'}",
                BEYOND,
                quantity=name,
                **also,
            )
        )

    if known.speeds is not None:
        low, high = known.speeds
        outside = [v for v in speeds if not (1 - MARGIN) * low <= v <= (1 + MARGIN) * high]
        if outside:
            say(("the speed is", max(outside, key=lambda v: max(low / max(v, 1e-9), v / max(high, 1e-9))), "u", "m/s"))
    harder: list[tuple[str, float, str, str]] = []
    if known.rudder is not None and rudder is not None and rudder > (1 + MARGIN) * known.rudder:
        harder.append(("the rudder goes to", rudder, "delta", "rad"))
    if known.rate is not None and rate is not None and rate > (1 + MARGIN) * known.rate * _faster(known, speeds):
        harder.append(("the ship turns at", rate, "r", "rad/s"))
    if harder:
        say(*harder)
    if known.drift is not None and drift is not None and drift > (1 + MARGIN) * known.drift:
        say(("the drift angle is", drift, "beta", "rad"))
    notices += [
        _other_loading(section, ship, m, value, span) for m, value, span in _loadings(model, known, loading or {})
    ]
    return notices


def _identified_otherwise(model: Model, ship: ParameterSet) -> list[Notice]:
    """What has to be said where the coefficients of a model were found with a part that the trials asked for, and it reads others."""
    if model.name in ship.joint and ship.joint[model.name].names:
        return []
    for name, joint in ship.joint.items():
        base, *ends = name.removeprefix(model.name).split("-") if name.startswith(model.name) else [name]
        if not base and joint.names and ends and all(f"-{end}" in ADDED for end in ends):
            return [
                Notice(
                    f"Ship {ship.name} was identified with [{name}], and model {model.name} reads other coefficients of hers: name the "
                    f"model {name}.",
                    OTHERWISE,
                    serious=True,
                )
            ]
    return []


def speed_given(inputs: Mapping[str, float]) -> float | None:
    """Return the speed among inputs that are held at a value, in m/s; None where it is none of them.

    Parameters
    ----------
    inputs : mapping of str to float
        Values by input, SI.
    """
    return inputs.get("cruise", inputs.get("u"))


def growth_beyond(
    model: Model, ship: ParameterSet, rudder: float | None, rate: float | None, speeds: Sequence[float] = ()
) -> float:
    """Return how many times as large as fitted the amplitudes of a manoeuvre are, 1 where they are not beyond.

    The error that a model has by its structure is taken as so many times as large in the bands of that manoeuvre.

    Parameters
    ----------
    model : Model
        What is run.
    ship : ParameterSet
        Whose coefficients.
    rudder, rate : float or None
        Largest rudder angle in rad and rate of turn in rad/s.
    speeds : sequence of float
        The speeds before the manoeuvre in m/s: a ship that is faster than she was tried at turns faster in proportion.

    Returns
    -------
    float
        The larger of both ratios, where it is beyond by more than a tenth. 1 where the ship states no amplitudes.
    """
    found = range_of(ship, model)
    if found is None:
        return 1.0
    known = found[1]
    ratios = []
    if rudder is not None and known.rudder:
        ratios.append(rudder / known.rudder)
    if rate is not None and known.rate:
        ratios.append(rate / (known.rate * _faster(known, speeds)))
    largest = max(ratios, default=1.0)
    return float(largest) if largest > 1 + MARGIN else 1.0


def growth_in_run(model: Model, ship: ParameterSet, speed: float, run: Mapping[str, np.ndarray]) -> float:
    """Return how many times as large as fitted the amplitudes of a simulated run are, see `growth_beyond`.

    Parameters
    ----------
    model : Model
        What was run.
    ship : ParameterSet
        Whose coefficients.
    speed : float
        Before the manoeuvre, in m/s.
    run : mapping of str to ndarray
        Columns of the run, SI; ``delta`` and ``r`` are read as far as they are there and finite.
    """
    rudder, rate = (_largest(np.abs(run[n])) if n in run else None for n in ("delta", "r"))
    return growth_beyond(model, ship, rudder, rate, [speed])


def _loadings(model: Model, known: Joint, loading: Mapping[str, float]) -> list[tuple[str, float, tuple[float, float]]]:
    """What says a loading, the one that a model is run at, and those it was fitted at, where the first is outside."""
    found = []
    for measure in ("draught", "displacement"):
        held = model[f"{measure}_held"].number("default") if f"{measure}_held" in model else None
        value, span = loading.get(measure, held), known.loadings.get(measure)
        if span is not None and value is not None and not (1 - _LOADED) * span[0] <= value <= (1 + _LOADED) * span[1]:
            found.append((measure, value, span))
    return found


def _other_loading(section: str, ship: ParameterSet, measure: str, value: float, span: tuple[float, float]) -> Notice:
    low, high = (shown(v, measure, digits=3) for v in span)
    return Notice(
        f"The {measure} is {shown(value, measure, digits=3)}: the [{section}] coefficients of ship {ship.name} were found at {low} to "
        f"{high}. Outside what was fitted their change with the loading is extrapolated, and no band contains that error.",
        BEYOND,
        quantity=measure,
    )


def beyond_in_run(
    model: Model,
    ship: ParameterSet,
    speed: float,
    run: Mapping[str, np.ndarray],
    *,
    known: bool = False,
    grown: float = 1.0,
) -> list[Notice]:
    """Return what has to be said of a simulated run beyond the range that the coefficients come from.

    Parameters
    ----------
    model : Model
        What was run.
    ship : ParameterSet
        Whose coefficients.
    speed : float
        Before the manoeuvre, in m/s.
    run : mapping of str to ndarray
        Columns of the run, SI; ``delta``, ``r``, ``u`` and ``v`` are read as far as they are there and finite.
    known : bool
        Whether to leave out that a range is not known.
    grown : float
        See `beyond`.

    Returns
    -------
    list of Notice
    """
    largest = {n: _largest(np.abs(run[n])) for n in ("delta", "r") if n in run}
    drift = _largest(np.abs(np.arctan2(run["v"], run["u"]))) if "u" in run and "v" in run else None
    found = beyond(model, ship, [speed], largest.get("delta"), rate=largest.get("r"), drift=drift, grown=grown)
    return [n for n in found if n.kind != UNKNOWN] if known else found


def _signs(model: Model, ship: ParameterSet) -> list[Notice]:
    """Coefficients below zero that the model declares from zero on: a ship that turns to port with her rudder to starboard, or runs away."""
    wrong = {}
    for name in model.parameters:
        value, low = ship.find(model, name), model[name].number("low")
        if value is None or low is None or low < 0:
            continue
        least = float(np.min(value.value))
        if least < 0:
            unit = "" if value.unit == "1" else f" {value.unit}"
            wrong[name] = f"{name} is {brief(least, 4)}{unit}"
    if not wrong:
        return []
    return [
        Notice(
            f"{', '.join(wrong.values())} in ship {ship.name}, and model {model.name} declares {'it' if len(wrong) == 1 else 'them'} from zero "
            "on: with a gain below zero a ship turns to port with her rudder to starboard, with a time constant below zero she runs away. "
            "Correct the sign.",
            WRONG_SIGN,
            serious=True,
            names=list(wrong),
        )
    ]


def _largest(sizes: np.ndarray) -> float | None:
    there = sizes[np.isfinite(sizes)]
    return float(there.max()) if there.size else None


def _unstated(known: Joint | None, steers: bool) -> list[str]:
    """What a set does not state of the range: a rudder angle matters where one is steered, or where nothing is stated."""
    lacking = {
        "speeds": known is None or known.speeds is None,
        "rudder angles": known is None or known.rudder is None,
    }
    return [what for what, lacks in lacking.items() if lacks and (what == "speeds" or steers or lacking["speeds"])]


def _faster(known: Joint, speeds: Sequence[float]) -> float:
    """A ship that is faster turns faster, at the same rate in ship lengths."""
    return max(1.0, max(speeds) / known.speeds[1]) if speeds and known.speeds and known.speeds[1] > 0 else 1.0
