"""The commands: the function of each, and its line in the help. A new command is a file of its own and a line here."""

from __future__ import annotations

#: Command: the function, as module:name, and its line in the help; in the order of the work.
COMMANDS = {
    "models": ("shipid.cli.ships.catalogue:models", "List models and ships, one line each."),
    "show": ("shipid.cli.ships.catalogue:show", "Show a model: quantities, units, equations, sources."),
    "ship": ("shipid.cli.ships.ship:ship", "Show a ship: values, units, sources; or draft the file of a new one."),
    "simulate": ("shipid.cli.ships.simulate:simulate", "Simulate a manoeuvre and write it as a trial."),
    "format": ("shipid.cli.trials.format:format_log", "Draft a format file for a log, with a reason for each column."),
    "check": ("shipid.cli.trials.check:check", "Find what is wrong with a trial, and repair it."),
    "measure": ("shipid.cli.trials.measure:measure", "Measure a zig-zag, a turning circle, a spiral or a pull-out."),
    "report": ("shipid.cli.trials.report:report", "Report a trial day: every manoeuvre measured, beside IMO's limits."),
    "compare": (
        "shipid.cli.identification.compare:compare",
        "Rank models by how they predict what they were not fitted to.",
    ),
    "plan": ("shipid.cli.trials.plan:plan", "Plan the most informative manoeuvres within a time."),
    "identify": ("shipid.cli.identification.identify:identify", "Identify a model from one trial or several."),
    "filter": (
        "shipid.cli.identification.filter:filter_trial",
        "Filter a trial, or samples as they arrive, with a Kalman filter.",
    ),
    "tune": ("shipid.cli.voyages.tune:tune", "Tune a gain-scheduled autopilot, with its report."),
    "predict": ("shipid.cli.voyages.predict:predict", "Predict where a ship goes under an order, with a band."),
    "bridge": ("shipid.cli.voyages.bridge:bridge", "Open the live bridge page of a ship, simulated or listened to."),
    "campaign": ("shipid.cli.others.campaign:campaign", "Run a study many times, or identify each trial of a folder."),
    "track": ("shipid.cli.others.track:track", "Track other ships from the plots of radar, lidar or AIS."),
    "criteria": ("shipid.cli.ships.criteria:criteria", "Evaluate a model against IMO's manoeuvring criteria."),
    "completion": ("shipid.cli.completion:completion", "Print the script that completes shipid in bash, zsh or fish."),
}
