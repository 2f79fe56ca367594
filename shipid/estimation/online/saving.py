"""The state of an online filter in a file: every number exactly, and only for the filter it came from."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shipid.estimation.errors import SavedStateError
from shipid.foundation.errors import UsageError

if TYPE_CHECKING:
    from shipid.estimation.kalman import ExtendedKalmanFilter
    from shipid.estimation.online.online_filter import OnlineFilter

_SCHEMA = 2


def save_state(online: OnlineFilter, path: Path) -> None:
    """Write the state of a filter (see `OnlineFilter.save`).

    Parameters
    ----------
    online : OnlineFilter
        The filter.
    path : Path
        The file.
    """
    if online.stepper is None:
        raise UsageError("a filter that has taken no sample has no state to save.")
    brief = online.filter.layout.brief
    state = {
        "schema": _SCHEMA,
        "model": online.filter.base.name,
        "filter": fingerprint(online.filter),
        "began": float(online._began or 0.0).hex(),
        "clock": [[float(v).hex() for v in part] for part in online._clock.state],
        "carried": [float(v).hex() for v in online.stepper.z],
        "out": [float(v).hex() for v in online.stepper.out[: brief["ll"].stop]],
        "counts": online._counts,
        "rejected": online.rejected,
        "refused": online.refused,
        "unseen": sorted(online._unseen),
    }
    scratch = path.with_name(f".{path.name}.part")
    scratch.write_text(json.dumps(state, indent=1), encoding="utf-8")
    scratch.replace(path)


def restore_state(kalman: ExtendedKalmanFilter, path: Path) -> OnlineFilter:
    """Return a filter as it was saved (see `ExtendedKalmanFilter.restore`).

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The same filter as the saved one.
    path : Path
        The file.
    """
    online: OnlineFilter = kalman.start()
    try:
        state = json.loads(path.read_text(encoding="utf-8"))
        numbers = [float.fromhex(v) for v in state["carried"]]
        out = [float.fromhex(v) for v in state["out"]]
        online._began = float.fromhex(state["began"])
        online._clock.state = [[float.fromhex(v) for v in part] for part in state["clock"]]
        online._counts, online.rejected = dict(state["counts"]), dict(state["rejected"])
        online.refused, online._unseen = int(state["refused"]), set(state["unseen"])
    except OSError as error:
        raise SavedStateError(f"the saved state {path} cannot be read: {error.strerror}.") from None
    except (ValueError, KeyError, TypeError):
        raise SavedStateError(f"{path} is no saved state of a filter: start a new one with start().") from None
    if state.get("schema") != _SCHEMA or state.get("filter") != fingerprint(kalman):
        raise SavedStateError(
            f"{path} was saved by another filter (of model {state.get('model')}): model, sensors, noise and options "
            "have to be the same. Make the filter as it was, or start a new one."
        )
    online.stepper = kalman.loop().one_at_a_time(np.array(numbers), kalman.constants)
    online.stepper.out[:] = out
    return online


def fingerprint(kalman: ExtendedKalmanFilter) -> str:
    """Return a hash of everything that makes two filters the same.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        A filter.
    """
    settings = (
        kalman.system.digest,
        kalman.measured,
        kalman.sources,
        [float(v).hex() for v in kalman.constants],
        kalman.form,
        kalman.gate,
        kalman.switchable,
        kalman.single,
        kalman._integration,
        sorted(kalman.parameters.items()),
        *(sorted(settings.items()) for settings in (kalman.rates, kalman.ranges, kalman.inputs, kalman.lost)),
    )
    return hashlib.sha256(repr(settings).encode()).hexdigest()
