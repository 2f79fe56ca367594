"""Names of purposes, methods and losses; the command line imports no more than this.

A purpose leads to a method; a method named by the user overrides it.
"""

from __future__ import annotations

from typing import Literal, get_args

Purpose = Literal["prediction", "filter"]
Method = Literal["output-error", "equation-error", "instrumental-variables", "multiple-shooting", "prediction-error"]
Loss = Literal["linear", "huber", "soft-l1"]
#: Method: what it does, in words.
METHODS: dict[Method, str] = {
    "output-error": "output error over whole records",
    "equation-error": "equation error by least squares",
    "instrumental-variables": "equation error by instrumental variables",
    "multiple-shooting": "multiple shooting, finished by output error",
    "prediction-error": "prediction error through the Kalman filter",
}
#: Methods that minimise the residuals of whole records; None is the ladder of them.
OUTPUT_ERROR: tuple[Method | None, ...] = (None, "output-error", "multiple-shooting")
#: Purpose: the method it leads to. The default is a fit for prediction.
PURPOSES: dict[Purpose, Method | None] = {"prediction": None, "filter": "prediction-error"}
#: Losses: squares, and two in which large residuals count less than their square.
LOSSES: tuple[Loss, ...] = get_args(Loss)
