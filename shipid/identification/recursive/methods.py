"""The family: its members differ in the output that the next prediction starts from, and in the gain.

All of them predict one output a sample ahead with the model, ``ybar = psi' theta``, and correct output and parameters by the
innovation: ``yhat = ybar + K_y e``, ``theta = theta + K_theta e``. Passenier (1989), section 4.5.3, shows each as an extended
Kalman filter with parts of the covariance left out; here each is written in that way.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from shipid.foundation.errors import UnknownNameError


@dataclass(frozen=True)
class Method:
    """One member of the family.

    Attributes
    ----------
    name, line : str
        Its name on the command line, and what it is in one line.
    source : str
        Where its equations are printed.
    previous_output : {"measured", "predicted", "weighted", "optimal"}
        The output the next prediction starts from: the measurement (K_y = 1), the model's own (K_y = 0), or a mean of the two
        by their variances, without or with the correlation between output and parameters.
    forgets : bool
        Whether it takes a forgetting factor.
    uses_noise_level : bool
        Whether the gain depends on the noise level. Otherwise only its ratio to the first standard deviations matters, and
        intervals are scaled by the size of the innovations.
    instruments : bool
        Whether parameters are corrected along the output of an auxiliary model, which measurement noise does not enter.
    projects : bool
        Whether the model it runs is kept stable.
    linear : bool
        Whether the model has to be linear in the parameters.
    separate : bool
        Whether the output is weighted apart from the parameters: the uncertainty of the output has then no part in K_theta.
    """

    name: str
    line: str
    source: str
    previous_output: Literal["measured", "predicted", "weighted", "optimal"]
    forgets: bool = False
    uses_noise_level: bool = True
    instruments: bool = False
    projects: bool = False
    linear: bool = True
    separate: bool = False

    @property
    def is_biased(self) -> bool:
        """Whether noise of the measured output enters the regressors, and biases the parameters."""
        return self.previous_output == "measured" and not self.instruments

    @property
    def first_factor(self) -> float:
        """First variances of the gains in those given.

        One equation error holds little information where a ship is sampled finely: with the first variances as they are given,
        least squares would hardly move from its first estimates.
        """
        return 100.0 if self.previous_output == "measured" and not self.uses_noise_level else 1.0


_ALL = (
    Method(
        "ekf",
        "extended Kalman filter of output and parameters: smallest scatter; needs a realistic start",
        "Passenier (1989), eq. (4.111)-(4.119)",
        "optimal",
        linear=False,
    ),
    Method(
        "rls",
        "recursive least squares, with forgetting: quick, and biased by measurement noise",
        "Passenier (1989), eq. (4.57)-(4.64)",
        "measured",
        forgets=True,
        uses_noise_level=False,
    ),
    Method(
        "series-parallel",
        "series-parallel MRAS, the same recursion as rls",
        "Passenier (1989), eq. (4.62)",
        "measured",
        forgets=True,
        uses_noise_level=False,
    ),
    Method(
        "mras-parallel",
        "parallel MRAS (output error), kept stable: without bias, and slow",
        "Passenier (1989), eq. (4.63); Landau (1976)",
        "predicted",
        forgets=True,
        uses_noise_level=False,
        projects=True,
    ),
    Method(
        "minimum-variance",
        "minimum variance (Markov): least squares weighted by the noise level; biased as rls",
        "Passenier (1989), eq. (4.134)-(4.139)",
        "measured",
    ),
    Method(
        "combined",
        "combined MRAS: starts as series-parallel, ends as parallel; robust, without much bias",
        "Passenier (1989), eq. (4.126)-(4.132)",
        "weighted",
    ),
    Method(
        "combined-heuristic",
        "combined MRAS as first derived: output and parameters weighted apart",
        "Passenier (1989), eq. (4.83)-(4.94), with the 1 of (4.74) read as R: it is printed in units of the noise",
        "weighted",
        separate=True,
    ),
    Method(
        "instrumental-variables",
        "least squares along an auxiliary model's output: without bias; needs a manoeuvre from the start",
        "Young (1970); Söderström and Stoica (1989), section 9.3",
        "measured",
        forgets=True,
        uses_noise_level=False,
        instruments=True,
    ),
)

#: Every method by its name on the command line.
METHODS: dict[str, Method] = {m.name: m for m in _ALL}


def find_method(name: str) -> Method:
    """Return a method by name.

    Parameters
    ----------
    name : str
        A key of `METHODS`.

    Raises
    ------
    UnknownNameError
        If there is none.
    """
    if name not in METHODS:
        raise UnknownNameError("method of recursive identification called", name, METHODS)
    return METHODS[name]
