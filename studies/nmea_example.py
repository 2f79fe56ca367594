"""An example log: a simulated zig-zag as the NMEA 0183 log a bridge would have kept of it, and what is read back.

The ship is simulated, and its instruments print it as they do: gyro, rate of turn, rudder and its order
five times a second, log and receiver once, each with the decimals such sentences have, and with the logger's time before every
line. One line has a wrong checksum and one was cut. The rows compare the trial that is read with the one that was sailed,
and the coefficients identified on it with those it was simulated with.

    python studies/nmea_example.py [--write] [--hours 8] [--json]

``--write`` writes studies/trials/zigzag-20-20.nmea anew; ``--hours`` times the reading of a log of that length with ten
sentences a second.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from _table import Row, below, close, show

import shipid
from shipid.trials.logs.geodesy import to_geographic, to_local
from shipid.trials.logs.nmea.writing import ORIGIN, RATES, START, nmea_lines

HERE = Path(__file__).parent
LOG = HERE / "trials" / "zigzag-20-20.nmea"
FORMAT = HERE / "formats" / "nmea-example.toml"
COMMENT = (
    "Simulated, not measured: a 20/20 zig-zag of the Zeefakkel (model norrbin, 9 kn) as an NMEA 0183 log",
    "Written by studies/nmea_example.py; read with: shipid measure zigzag-20-20.nmea --format nmea",
    "A line with a wrong checksum and one that was cut are in it on purpose",
)
#: Sentences of the example, and how many there are a second.
SENTENCES = {k: v for k, v in RATES.items() if k not in ("GPVTG", "WIMWV")}

# Half of the last decimal, in the unit of the trial; positions: half of 0.00001 minutes, and as much for the origin.
RESOLUTION = {
    "psi": np.radians(0.05),
    "r": np.radians(0.05) / 60,
    "u": 0.005 * 1852 / 3600,
    "v": 0.005 * 1852 / 3600,
    "delta": np.radians(0.05),
    "delta_order": np.radians(0.05),
    "x": 0.0186,
    "y": 0.0186,
}


def sailed() -> shipid.Trial:
    """The zig-zag as it was simulated."""
    return shipid.simulate(
        shipid.find_model("norrbin"), "zeefakkel", "zigzag:20/20", speed="9 kn", sampling="0.05 s", name="zigzag-20-20"
    )


def write(truth: shipid.Trial) -> None:
    """Write the example log with its two bad lines."""
    lines = list(nmea_lines(truth, SENTENCES))
    rot = [k for k, line in enumerate(lines) if "$HEROT" in line]
    lines[rot[200]] = lines[rot[200]].replace("$HEROT,", "$HEROT,9")  # garbled: the checksum tells
    lines[rot[400]] = lines[rot[400]].rpartition(",")[0]  # cut
    text = "".join(f"# {line}\r\n" for line in COMMENT) + "".join(line + "\r\n" for line in lines)
    LOG.write_text(text, encoding="ascii", newline="")


def interpolated(truth: shipid.Trial, name: str, rate: float, slot: int) -> np.ndarray:
    """What an instrument that prints every decimal would give: the truth at its instants, interpolated between."""
    t = truth["t"]
    at = np.arange(t[0] + 0.013 * slot, t[-1] + 1e-9, 1 / rate)
    return np.interp(t, at, np.interp(at, t, truth[name]))


def differences(truth: shipid.Trial, read: shipid.Trial) -> list[Row]:
    """The largest difference of each channel, against the resolution of its sentence."""
    address = {"psi": "HEHDT", "r": "HEROT", "u": "VDVBW", "v": "VDVBW", "x": "GPGGA", "y": "GPGGA"}
    address |= {"delta": "IIRSA", "delta_order": "IIROR"}
    rows = []
    for name, limit in RESOLUTION.items():
        at, slot = address[name], list(SENTENCES).index(address[name])
        expected = np.interp(read["t"], truth["t"], interpolated(truth, name, SENTENCES[at], slot))
        if name in ("x", "y"):  # the trial's origin is the first fix
            first = 0.013 * slot
            expected = expected - np.interp(first, truth["t"], truth[name])
        # Stamps are whole milliseconds: a signal moves by its slope in half of one.
        slope = float(np.abs(np.diff(truth[name]) / np.diff(truth["t"])).max())
        error = float(np.abs(read[name] - expected).max())
        limit = limit + 0.0011 * slope
        unit = truth.unit(name)
        rows.append(Row(f"{name} ({at})", f"within {limit:.2g} {unit}", f"{error:.2g} {unit}", error <= limit))
    return rows


def identified(read: shipid.Trial) -> list[Row]:
    """The coefficients, identified on the log, against those of the simulation."""
    fit = shipid.identify(shipid.find_model("norrbin"), [read], ship="zeefakkel")
    speed = 9 * 1852 / 3600
    # The ship's set tabulates K and tau over the speed.
    truth = {
        "K": np.interp(speed, [4.0, 5.0], [0.37, 0.50]),
        "tau": np.interp(speed, [4.0, 5.0], [33.0, 31.0]),
        "n3": 0.4 * np.degrees(1) ** 2,
    }
    found = fit.to_dict()["parameters"]
    return [close(f"{n}, identified", v, found[n]["value"], 0.02 * v, found[n]["unit"]) for n, v in truth.items()]


def long_log(hours: float) -> list[Row]:
    """Read a log of ten sentences a second: the example over and over, with a clock that runs on."""
    from datetime import timedelta

    cycle = [line.split(" ", 1)[1] for line in nmea_lines(sailed(), {k: v * 10 / 23 for k, v in SENTENCES.items()})]
    count = round(hours * 36000)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.nmea"
        with path.open("w", encoding="ascii") as file:
            for k in range(count):
                moment = START + timedelta(seconds=k / 10)
                file.write(f"{moment:%Y-%m-%dT%H:%M:%S}.{moment.microsecond // 1000:03d}Z {cycle[k % len(cycle)]}\n")
        begin = time.perf_counter()
        trial = shipid.read_trial(path, format="nmea")
        spent = time.perf_counter() - begin
    what = f"{hours:g} h, {count} sentences, {len(trial)} samples: seconds a reading"
    return [Row(what, "below 60 s for 8 h", f"{spent:.1f} s ({count / spent:,.0f} sentences/s)", spent < 7.5 * hours)]


def plane() -> list[Row]:
    """Local metres against the earth-centred coordinates they stand for, in 40 digits."""
    from mpmath import cos, mp, mpf, sin, sqrt

    mp.dps = 40
    f = 1 / mpf("298.257223563")
    e2 = f * (2 - f)

    def centred(lat: float, lon: float) -> tuple:
        n = mpf(6378137) / sqrt(1 - e2 * sin(lat) ** 2)
        return n * cos(lat) * cos(lon), n * cos(lat) * sin(lon), n * (1 - e2) * sin(lat)

    lat0, lon0 = map(mpf, ORIGIN)
    home, worst = centred(lat0, lon0), 0.0
    for north, east in ((3000, 0), (0, 3000), (-4000, 3000), (5000, -5000)):
        lat, lon = (float(a) for a in to_geographic(north, east, ORIGIN))
        d = [a - b for a, b in zip(centred(mpf(lat), mpf(lon)), home)]
        x = -sin(lat0) * cos(lon0) * d[0] - sin(lat0) * sin(lon0) * d[1] + cos(lat0) * d[2]
        y = -sin(lon0) * d[0] + cos(lon0) * d[1]
        found = to_local(lat, lon, ORIGIN)
        worst = max(worst, float(abs(x - found[0])), float(abs(y - found[1])))
    return [below("local metres against 40 digits, within 7 km", 1e-6, worst, "m")]


def main() -> None:
    hours = 0.0
    if "--hours" in sys.argv:
        at = sys.argv.index("--hours")
        hours = float(sys.argv[at + 1])
        del sys.argv[at : at + 2]
    truth = sailed()
    if "--write" in sys.argv:
        sys.argv.remove("--write")
        write(truth)
    read = shipid.read_trial(LOG, format=FORMAT)
    rows = differences(truth, read)
    notes = "; ".join(read.source.notes)
    rows.append(
        Row("bad lines", "one cut, one garbled", f"{notes.count('1 line was')} named", notes.count("1 line was") == 2)
    )
    rows += [Row("says that it is simulated", "yes", "yes" if read.source.simulated else "no", read.source.simulated)]
    measured, sailed_numbers = shipid.measure(read), shipid.measure(truth)
    for k in range(2):
        rows.append(
            close(
                f"overshoot {k + 1}",
                np.degrees(sailed_numbers.overshoots[k]),
                np.degrees(measured.overshoots[k]),
                0.5,  # the order is seen 0.2 s late at most, and the ship turns at 2.5 deg/s
                "deg",
                digits=3,
            )
        )
    rows += identified(read) + plane()
    if hours:
        rows += long_log(hours)
    show("An NMEA 0183 log, written and read", rows, "Read as:\n  " + "\n  ".join(read.source.notes))


if __name__ == "__main__":
    main()
