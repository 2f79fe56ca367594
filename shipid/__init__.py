"""shipid: declare a ship model once; identify it from trials, and generate everything else.

The names below are loaded when they are first used, so that importing the package costs nothing.
"""

from __future__ import annotations

import importlib
from typing import Any

__version__: str = "0.1.0"

_HOMES = {
    "Component": "shipid.declaration.component",
    "state": "shipid.declaration.quantity",
    "given": "shipid.declaration.quantity",
    "derived": "shipid.declaration.quantity",
    "constant": "shipid.declaration.quantity",
    "parameter": "shipid.declaration.quantity",
    "output": "shipid.declaration.quantity",
    "guard": "shipid.declaration.guard",
    "join": "shipid.declaration.joining.join",
    "replace_component": "shipid.declaration.joining.join",
    "Model": "shipid.declaration.model",
    "augment": "shipid.declaration.joining.augment",
    "ParameterSet": "shipid.parameters.parameter_set",
    "read_parameter_set": "shipid.parameters.parameter_file",
    "write_parameter_set": "shipid.parameters.parameter_file",
    "find_model": "shipid.parameters.catalogue",
    "find_ship": "shipid.parameters.catalogue",
    "generate": "shipid.generation.system",
    "linearise": "shipid.generation.linearisation",
    "typeset": "shipid.generation.typesetting.typeset",
    "Trial": "shipid.trials.trial",
    "read_trial": "shipid.trials.logs.reading",
    "write_trial": "shipid.trials.logs.writing",
    "check_trial": "shipid.trials.doctor.check_trial",
    "measure": "shipid.trials.measuring.measure",
    "simulate": "shipid.trials.manoeuvres.simulate",
    "Cascade": "shipid.estimation.several.cascade",
    "ExtendedKalmanFilter": "shipid.estimation.kalman",
    "InteractingMultipleModel": "shipid.estimation.multiple.interacting",
    "Mode": "shipid.estimation.multiple.modes",
    "Fit": "shipid.identification.fit",
    "assess": "shipid.identification.assess",
    "compare_models": "shipid.identification.compare_models",
    "RecursiveIdentifier": "shipid.identification.recursive.identifier",
    "identify_recursively": "shipid.identification.recursive.identifier",
    "identify": "shipid.identification.identify",
    "plan_trials": "shipid.planning.plan_trials",
    "manoeuvring_criteria": "shipid.criteria.manoeuvring_criteria",
    "trial_sheet": "shipid.criteria.measured.trial_sheet",
    "design_autopilot": "shipid.autopilot.design.design_autopilot",
    "judge": "shipid.autopilot.judgement.judge",
    "run_on_board": "shipid.autopilot.on_board.run_on_board",
    "read_schedule": "shipid.autopilot.design.read_schedule",
    "write_schedule": "shipid.autopilot.design.write_schedule",
    "Situation": "shipid.prediction.situations.situation",
    "TrackPredictor": "shipid.prediction.tracks.track_predictor",
    "TrackPilot": "shipid.prediction.following.track_pilot",
    "own_ship_filter": "shipid.prediction.situations.own_ship_filter",
    "predict_track": "shipid.prediction.predict_track",
    "predict_route": "shipid.prediction.predict_route",
    "sail": "shipid.prediction.sailing.sail",
    "sail_route": "shipid.prediction.sailing.sail_route",
    "read_chart": "shipid.prediction.charts.read_chart",
    "Route": "shipid.prediction.routes.route",
    "read_route": "shipid.prediction.routes.read_route",
    "write_route": "shipid.prediction.routes.read_route",
    "situation_of": "shipid.prediction.situations.filtered_situation",
    "avoid": "shipid.encounter.avoid",
    "closest_approach": "shipid.encounter.closest_approach",
    "Campaign": "shipid.campaign.campaign",
    "Measure": "shipid.campaign.campaign",
    "run_campaign": "shipid.campaign.run_campaign",
    "plot": "shipid.report.plot",
    "write_report": "shipid.report.write_report",
    "ShipidError": "shipid.foundation.errors",
}

#: What does in Python what a command of another name does.
_COMMANDS = {
    "show": ("find_model",),
    "ship": ("find_ship",),
    "check": ("check_trial",),
    "report": ("trial_sheet", "write_report"),
    "compare": ("compare_models",),
    "plan": ("plan_trials",),
    "filter": ("ExtendedKalmanFilter",),
    "tune": ("design_autopilot", "judge"),
    "predict": ("predict_track", "predict_route"),
    "campaign": ("run_campaign",),
    "track": ("encounter.tracking.track.track",),
    "criteria": ("manoeuvring_criteria",),
}
#: Names that stand in this file and belong to others.
_BORROWED = ("Any", "annotations", "importlib")

__all__ = [*sorted(_HOMES), "__version__"]


def __getattr__(name: str) -> Any:  # noqa: ANN401 - it hands on names of every kind
    if name == "models":  # the ship models: a package of its own, which this one does not read
        return importlib.import_module("shipid.models")
    try:
        home = _HOMES[name]
    except KeyError:
        raise AttributeError(f"module 'shipid' has no attribute '{name}'{_instead(name)}") from None
    value = getattr(importlib.import_module(home), name)
    globals()[name] = value
    return value


def _instead(name: str) -> str:
    """What may have been meant: the function of a command, or a name that is spelt alike."""
    import difflib

    if name in _COMMANDS:
        return f": in Python the command 'shipid {name}' is {' and '.join(f'shipid.{n}' for n in _COMMANDS[name])}"
    meant = difflib.get_close_matches(name, __all__, 1)
    return f". Did you mean shipid.{meant[0]}?" if meant else ""


def __dir__() -> list[str]:
    return sorted({*(n for n in globals() if n not in _BORROWED), *__all__, "models"})
