#!/usr/bin/env python3
"""Values without a unit, or with one that does not fit, are refused; what the wrong unit would do to a ship.

Norrbin's cubic coefficient of the Zeefakkel is published as n3 = 0.4 without a unit. It belongs to rates in deg/s.
"""

from __future__ import annotations

import numpy as np
from _table import Row, close, show

from shipid import ShipidError, find_model, find_ship
from shipid.generation.simulator import make_simulator
from shipid.parameters.parameter_set import parse_value

LENGTH, SPEED = 45.0, 5.0  # m, m/s
RUDDER = 30 * np.pi / 180


def refused(assignment: str, shown: tuple[str, ...]) -> tuple[Row, str]:
    """Give n3 a value that should be refused, with both units in the message."""
    try:
        _, number = parse_value(find_model("norrbin"), assignment)
    except ShipidError as error:
        says = str(error)
        return Row(assignment, "refused, naming " + " and ".join(shown), "refused", all(s in says for s in shown)), says
    return Row(assignment, "refused", f"taken as {number:g}", False), ""


def radius(n3: str) -> tuple[float, float]:
    """Return R/L of the steady turn at 30 deg of rudder, simulated, and by the cubic K delta = r + n3 r^3."""
    model, ship = find_model("norrbin"), find_ship("zeefakkel")
    values = {"K": "0.5 1/s", "tau": "31 s", "n3": n3}
    whole = model.impose(list(values))
    known = {n: parse_value(model, f"{n}={v}")[1] for n, v in values.items()}
    # The equations alone: `simulate` refuses the turn in which no ship turns so fast.
    t = np.arange(0.0, 400.0, 0.2)
    run = make_simulator(whole, ("r",))(
        t, ship.values(whole, speed=SPEED) | known, {"u": SPEED, "cruise": SPEED, "delta": RUDDER}
    )
    cubic = known["n3"]
    roots = np.roots([cubic, 0, 1, -0.5 * RUDDER])
    exact = float(roots[np.abs(roots.imag) < 1e-12].real[0])
    return SPEED / run["r"][-1] / LENGTH, SPEED / exact / LENGTH


def main() -> None:
    """Print the table."""
    tried = [
        refused("n3=0.4", ("no unit", "s²/rad²", "s²/deg²")),
        refused("n3=0.4 s^2", ("s²/rad²", "s²")),
        refused("n3=0.4 1/s", ("s²/rad²", "1/s")),
    ]
    rows = [row for row, _ in tried]
    _, number = parse_value(find_model("norrbin"), "n3=0.4 s^2/deg^2")
    rows.append(close("n3 = 0.4 s²/deg² inside", 1313.12, number, 5e-3, "s²/rad²", 6))
    rows.append(close("too small by, if taken for s²/rad²", 3283, number / 0.4, 0.5, "times", 4))
    for n3, wanted in (("0.4 s^2/deg^2", 2.05), ("0.4 s^2/rad^2", 0.44)):
        simulated, exact = radius(n3)
        rows.append(close(f"R/L at 30 deg, n3 = {n3}", wanted, simulated, 5e-3, digits=3))
        rows.append(close("  the same by the cubic alone", exact, simulated, 1e-3 * exact, digits=4))
    messages = "\n".join(f"  {row.what}: {says}" for row, says in tried)
    show("Units of the Zeefakkel's n3", rows, f"What a user reads:\n{messages}")


if __name__ == "__main__":
    main()
