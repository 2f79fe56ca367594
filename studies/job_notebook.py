#!/usr/bin/env python3
"""The notebook user's job, cell by cell: read, fit, validate, draw, hand the ship to python-control, filter, tune.

python studies/job_notebook.py [--json]

The cells are marked with ``# %%``: an editor that knows notebooks runs them one by one. Only names of the public API stand in them,
beside NumPy, pandas and python-control. The trials are those of the README, simulated from a container ship with K* 1.6 and tau* 1.7
(De Keizer's model), so the truth is known.
"""

# %% The packages
from pathlib import Path

import control
import numpy as np
from _table import Row, close, show

import shipid
from shipid.models import DeKeizer, PlanarMotion, VanLeeuwenSway

here = Path(__file__).parent / "trials"
rows: list[Row] = []

# %% A trial, and its look
trial = shipid.read_trial(here / "container-20-20.csv")
figure = trial.plot()
samples = trial.to_frame()
units_named = all("[" in name for name in samples.columns)
rows.append(Row("trial.to_frame(): columns", "every column with its unit", ", ".join(samples.columns), units_named))
rows.append(
    Row("trial.plot()", "a figure with lines", f"{len(figure.axes)} axes", bool(figure.axes and figure.axes[0].lines))
)

# %% What the ship did
measured = shipid.measure(trial)
measured  # noqa: B018 - a notebook shows it

# %% A model of three components, fitted
own_ship = shipid.join("own ship", DeKeizer, VanLeeuwenSway, PlanarMotion)
fit = shipid.identify(own_ship, [trial], ship="soesterberg")
table = fit.to_frame()
for name, true in (("K", 1.6), ("tau", 1.7)):
    rows.append(close(f"fit.to_frame(): {name}", true, table["value"][name], 3 * table["std"][name], digits=3))

# %% A trial that it has not seen
fit = fit.validate([shipid.read_trial(here / "container-10-10.csv")])
rms = float(np.degrees(fit.to_dict()["validation"]["container-10-10"]["psi"]["rmse"]["value"]))
rows.append(Row("fit.validate(): heading of the 10/10, rms", "below 1 deg", f"{rms:.2f} deg", rms < 1.0))

# %% The figures of its report
drawn = {word: fit.plot(word) for word in ("heading", "track")}
rows.append(Row("fit.plot(...)", "figures with axes", ", ".join(drawn), all(f.axes for f in drawn.values())))

# %% The ship for python-control: Bode's plot from the rudder to the rate of turn
length, speed = 226.0, 9.0
plant = fit.to_control(f"{speed} m/s", inputs=["delta"], outputs=["r"])
K, tau = table["value"]["K"] * speed / length, table["value"]["tau"] * length / speed
omega = np.geomspace(1e-3, 1.0, 50)
answer = control.frequency_response(plant, omega)
nomoto = K / np.abs(1 + 1j * omega * tau)
apart = float(np.max(np.abs(np.asarray(answer.magnitude).ravel() / nomoto - 1)))
control.bode_plot(plant, omega)
rows.append(Row("fit.to_control(): Bode beside K / (1 + j w tau)", "the same to 1 %", f"{apart:.1e}", apart < 0.01))

# %% A filter over the record
sensors = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s"}
run = shipid.ExtendedKalmanFilter(own_ship, fit.ship, measured=sensors, estimated=["K"]).filter(trial)
estimates = run.to_frame()
run.plot()
rows.append(Row("filter: run.to_frame()", f"{len(trial)} rows", f"{len(estimates)} rows", len(estimates) == len(trial)))

# %% An autopilot, judged
pilot = shipid.design_autopilot(own_ship, fit.ship, speeds="7:10:1 m/s")
pilot.plot()
step = control.step_response(pilot.to_control()["psi", "psi_order"])
rows.append(
    close("pilot.to_control(): heading in the end, of 1", 1.0, float(np.ravel(step.outputs)[-1]), 0.05, digits=3)
)

# %% What a notebook shows of each of them
for what, result in {"trial": trial, "measured": measured, "fit": fit, "run": run, "pilot": pilot}.items():
    lines, page = len(repr(result).splitlines()), result._repr_html_()
    fits = lines <= 10 and page.startswith("<div>") and len(page) < 20_000
    rows.append(
        Row(f"{what} in a notebook", "10 lines, a short page", f"{lines} lines, {len(page) / 1000:.0f} kB", fits)
    )
known = dir(shipid.models)
rows.append(
    Row("dir(shipid.models)", "the components", f"{len(known)} names", {"DeKeizer", "PlanarMotion"} <= set(known))
)

# %% Asked and measured
show("A notebook, cell by cell", rows)
