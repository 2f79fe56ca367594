"""Logs, format files and live streams to break: sound ones of a simulated zig-zag, and seeded mutations of them."""

from __future__ import annotations

import bz2
import functools
import gzip
import io
import lzma
import random
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

import shipid
from shipid.trials.logs.nmea.writing import nmea_lines

#: What loggers, spreadsheets and people write where a number is expected, and what breaks parsers.
TOKENS = (
    b"", b"NaN", b"nan", b"-", b"--", b"null", b"#N/A", b"1e400", b"-1e400", b"inf", b"1e308", b"0", b"-0", b"1,5", b"1.002,5", b"1_0", b"0x1f",
    b"1.5D+03", b"9" * 400, b"-9999", b"511", b'"', b'"1,5"', b"''", b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", b"\x1b[31m", b"\x9b2J", b"\r", b"\n\n",
    b"\r\n", b",,,,", b";;;", b"\t\t", b"\xe2\x80\xae", b"\xc2\xa0", b"12:61:00", b"2026-13-40T99:00:00", b"25/12/2026 10:00 PM", b"t [s]", b"psi [deg^9^9]",
    b"[rad", b"(deg)", b"# ", b"=1+1", b"{{7*7}}", b"%s%n", b"../../etc", b"$", b"*00", b"*ZZ", b"$GPGGA,", b"!AIVDM,1,1,,A,", b"\xd9\xa1\xd9\xa2",
)  # fmt: skip
#: Values of a channel that are no measurements.
VALUES = (0.0, 1.0, -9999.0, 511.0, 1e30, -1e30, 1e300, 1e-300, float("nan"), float("inf"), 360.0, 32767.0)

TEXT = ("comma", "semicolon", "tab", "blank", "quoted", "decimal comma", "dates", "units row", "utf-16", "gzip")


@functools.cache
def table() -> pd.DataFrame:
    """A simulated zig-zag with noise, positions and speed, a sample a second: units in the headers."""
    trial = shipid.simulate(
        shipid.find_model("norrbin"),
        "zeefakkel",
        "zigzag:20/20",
        noise="standard",
        sampling="1 s",
        duration="180 s",
        seed=1,
    )
    return trial.to_frame().round(5)


@functools.cache
def text(form: str) -> bytes:
    """The record as text in one of the forms of `TEXT`."""
    frame = table()
    separator = {"semicolon": ";", "decimal comma": ";", "tab": "\t", "blank": " "}.get(form, ",")
    if form == "blank":
        frame = frame.rename(columns=lambda name: name.replace(" ", ""))
    if form == "dates":
        stamps = pd.Timestamp("2026-05-04T23:59:00") + pd.to_timedelta(frame["t [s]"], unit="s")
        frame = frame.drop(columns="t [s]")
        frame.insert(0, "time", stamps.dt.strftime("%Y-%m-%dT%H:%M:%S.%f"))
    written = frame.to_csv(
        index=False,
        sep=separator,
        quoting=1 if form == "quoted" else 0,
        decimal="," if form == "decimal comma" else ".",
    )
    if form == "units row":
        first, rest = written.split("\n", 1)
        names, units = zip(*(head.rstrip("]").split(" [") for head in first.split(",")))
        written = "\n".join([",".join(names), ",".join(units), rest])
    return {"utf-16": lambda: written.encode("utf-16"), "gzip": lambda: gzip.compress(written.encode())}.get(
        form, written.encode
    )()


@functools.cache
def binary(suffix: str) -> bytes:
    """The record as a binary table; empty where the package that writes it is not installed."""
    frame = table()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"log{suffix}"
        try:
            if suffix == ".parquet":
                frame.to_parquet(path)
            elif suffix == ".xlsx":
                frame.to_excel(path, index=False)
            elif suffix == ".mat":
                from scipy.io import savemat

                savemat(path, {"log": {head.split(" [")[0]: frame[head].to_numpy() for head in frame}})
            else:
                import h5py

                with h5py.File(path, "w") as file:
                    for head in frame:
                        name, _, unit = head.rstrip("]").partition(" [")
                        file[name] = frame[head].to_numpy()
                        file[name].attrs["units"] = unit
        except ImportError:
            return b""
        return path.read_bytes()


@functools.cache
def nmea() -> bytes:
    """The record as an NMEA 0183 log."""
    trial = shipid.Trial.from_frame(table())
    return ("\r\n".join(nmea_lines(trial)) + "\r\n").encode()


@functools.cache
def canboat() -> bytes:
    """The record as NMEA 2000 in canboat's text form: heading, rudder, rate of turn, course and speed, position, a fix frame by frame."""
    frame = shipid.Trial.from_frame(table())
    lines = ["# format=FAST"]
    for k in range(len(frame)):
        stamp = (pd.Timestamp("2026-05-04T10:00:00") + pd.Timedelta(seconds=float(frame["t"][k]))).strftime(
            "%Y-%m-%dT%H:%M:%S.%f"
        )[:-3] + "Z"
        angle = [int((v % (2 * np.pi)) * 1e4).to_bytes(2, "little") for v in (frame["psi"][k], frame["psi"][k])]
        rudder = int(frame["delta"][k] * 1e4).to_bytes(2, "little", signed=True)
        rate = int(frame["r"][k] / 3.125e-8).to_bytes(4, "little", signed=True)
        speed = int(frame["u"][k] * 100).to_bytes(2, "little") if frame.has("u") else b"\xff\xff"
        place = b"".join(int(v * 1e7).to_bytes(4, "little", signed=True) for v in (54.0 + 1e-5 * k, 10.0))
        messages = [
            (127250, b"\x01" + angle[0] + b"\xff\x7f\xff\x7f\xfc"),
            (127245, b"\x00\xff\xff\x7f" + rudder + b"\xff\xff"),
            (127251, b"\x01" + rate + b"\xff\xff\xff"),
            (129026, b"\x01\xfc" + angle[1] + speed + b"\xff\xff"),
            (129025, place),
        ]
        if k % 5 == 0:
            fix = bytes([7]) + b"\x00" * 42
            frames = bytes([len(fix)]) + fix
            messages += [(129029, bytes([n]) + frames[7 * n : 7 * n + 7].ljust(7, b"\xff")) for n in range(7)]
        lines += [f"{stamp},2,{pgn},27,255,{len(body)}," + ",".join(f"{b:02x}" for b in body) for pgn, body in messages]
    return ("\n".join(lines) + "\n").encode()


def messages(random_: random.Random, strength: int) -> bytes:
    """A log of messages with what befalls such logs: cut lines, wrong and lost bytes, huge fields, other devices, clocks that jump."""
    lines = canboat().split(b"\n")
    for _ in range(strength):
        if not lines:
            break
        k = random_.randrange(len(lines))
        many = slice(k, k + random_.choice((1, 1, 5, 50, len(lines))))
        cells = [line.split(b",") for line in lines[many]]
        kind = random_.randrange(9)
        number = random_.choice((b"0", b"255", b"-1", b"99999", b"127245", b"129029", b"9" * 40, b"", b"x", b"1e9"))
        hexes = random_.choice((b"ff", b"7f", b"80", b"00", b"fe", b"0", b"zz", b"fff", b"ff" * 3000, b""))
        where = random_.randrange(1, 7) if kind == 0 else 6 + random_.randrange(8)
        years = random_.choice(
            (b"2026-05-04", b"2026-10-25", b"0001-01-01", b"9999-12-31", b"2026-02-30", b"1970-01-01")
        )
        clock = random_.choice((b"T10:00:00Z", b"-25:61:61", b"T02:59:59.999Z", b" 00:00:00", b"T10:00:00.123456789Z"))
        for one in cells:
            if len(one) < 8:
                continue
            if kind in (0, 1) and where < len(one):
                one[where] = number if kind == 0 else hexes
            elif kind == 2:  # another device, often with the same message
                one[3] = random_.choice((b"28", b"52", b"254"))
            elif kind == 3:
                one[0] = years + clock
            elif kind == 4:  # the clock is set, all after it goes on
                one[0] = one[0].replace(b"T10:", random_.choice((b"T09:", b"T11:", b"T23:")))
            elif kind == 5:
                del one[random_.randrange(len(one)) :]
            elif kind == 6 and sum(map(len, one)) < 300:  # or the log would soon be a gigabyte of one line repeated
                one[6:] = one[6:] * random_.choice((2, 40))
            elif kind == 7:
                one[7:] = [random_.choice((b"ff", b"00", b"80", b"7f")) for _ in one[7:]]
        lines[many] = [b",".join(one) for one in cells]
        if kind == 8:
            lines[many] = random_.choice((lines[many][::-1], lines[many] * 2, []))
    return b"\n".join(lines)


FORMAT = b"""ship = "zeefakkel"
separator = "comma"
header_lines = 1
[clock]
[columns.t]
column = "t"
unit = "s"
[columns.psi]
column = "psi"
unit = "deg"
[columns.r]
index = 2
unit = "deg/s"
sign = 1
scale = 1.0
[columns.delta]
column = "delta"
unit = "deg"
note = "port"
[repairs]
trailing = "drop"
[windows.middle]
span = [10, 150]
"""


def mutated(data: bytes, random_: random.Random, strength: int) -> bytes:
    """Change a file in some places: bytes, pieces, lines, and cells."""
    result = bytearray(data)
    for _ in range(strength):
        size = len(result)
        if not size:
            break
        at = random_.randrange(size)
        kind = random_.randrange(9)
        if kind == 0:
            result[at] = random_.randrange(256)
        elif kind == 1:
            del result[at : at + random_.choice((1, 2, 10, 200))]
        elif kind == 2:
            piece = bytes(result[at : at + random_.choice((1, 8, 300))])
            result[at:at] = piece * random_.choice((1, 2, 20))
        elif kind == 3:
            result[at:at] = random_.choice(TOKENS)
        elif kind == 4:
            del result[at if random_.random() < 0.3 else max(at, size - 50) :]
        else:
            lines = bytes(result).split(b"\n")
            k = random_.randrange(len(lines))
            if kind == 5:
                lines.insert(random_.randrange(len(lines)), lines[k])
            elif kind == 6:
                del lines[k]
            elif kind == 7:
                separator = next((s for s in (b",", b";", b"\t", b" ") if s in lines[k]), b",")
                cells = lines[k].split(separator)
                cells[random_.randrange(len(cells))] = random_.choice(TOKENS)
                lines[k] = separator.join(cells)
            else:
                other = random_.randrange(len(lines))
                lines[k], lines[other] = lines[other], lines[k]
            result = bytearray(b"\n".join(lines))
    return bytes(result)


def changed_table(random_: random.Random) -> pd.DataFrame:
    """A record whose text is sound and whose values are not: spikes, constants, holes, wild clocks, few rows."""
    frame = table().copy()
    generator = np.random.default_rng(random_.randrange(2**32))
    drop = [head for head in frame if head != "t [s]" and random_.random() < 0.2]
    frame = frame.drop(columns=drop if len(drop) < frame.shape[1] - 1 else drop[1:])
    for _ in range(random_.choice((1, 1, 2, 3, 8))):
        head = random_.choice(list(frame))
        column = frame[head].to_numpy(copy=True)
        size = len(column)
        if not size:
            break
        at = random_.randrange(size)
        some = slice(at, at + random_.choice((1, 2, 20, size)))
        kind = random_.randrange(8)
        if kind == 0:
            column[some] = random_.choice(VALUES)
        elif kind == 1:
            column[some] = np.nan
        elif kind == 2:
            column = column * random_.choice((-1, 57.3, 1 / 57.3, 1.94, 0, 1e12))
        elif kind == 3:
            column = np.roll(column, random_.randrange(-20, 20))
        elif kind == 4:
            column[some] = column[at]
        elif kind == 5:
            column = column[::-1].copy()
        elif kind == 6:
            column = generator.normal(size=size) * random_.choice((1e-9, 1, 1e9))
        else:
            column[generator.random(size) < random_.random()] = np.nan
        frame[head] = column
    if random_.random() < 0.3:
        frame = frame.iloc[: random_.choice((0, 1, 2, 3, 5, 9, 10, 11, 30))]
    if random_.random() < 0.1:
        frame = frame.sample(frac=1, random_state=random_.randrange(2**32))
    if random_.random() < 0.1:
        frame = pd.concat([frame, frame.iloc[-1:]])
    return frame


def compressed(data: bytes, random_: random.Random) -> tuple[bytes, str]:
    """A text compressed, with its suffix."""
    pack: Callable[[bytes], bytes]
    pack, suffix = random_.choice(((gzip.compress, ".gz"), (bz2.compress, ".bz2"), (lzma.compress, ".xz")))
    return pack(data), suffix


def window(random_: random.Random) -> str:
    """What a user might write behind the @."""
    number = random_.choice(
        ("", "0", "10", "100", "-5", "1e9", "nan", "inf", "-inf", "1e400", "x", "10 s", "0x10", "٣")
    )
    other = random_.choice(("", "0", "10", "100", "179", "1e9", "nan", "-inf", "y", "50:60", "1_0"))
    return random_.choice(
        (f"{number}:{other}", number, "middle", ":", "::", f"{number}:{other}@1:2", "#Sheet1", "\x1b[1m", "a" * 5000)
    )


def stream(random_: random.Random) -> bytes:
    """A live stream: the lines of a record, mutated."""
    frame = table()[[head for head in table() if head.split(" [")[0] in ("t", "psi", "r", "delta")]]
    source = frame.iloc[:40].to_csv(index=False).encode()
    if random_.random() < 0.3:
        source = text("dates" if random_.random() < 0.5 else "semicolon")[:3000]
    if random_.random() < 0.15:
        return messages(random_, random_.choice((1, 2, 4, 12)))[:6000]
    return mutated(source, random_, random_.choice((1, 2, 4, 12)))


def written(frame: pd.DataFrame) -> bytes:
    """A table as CSV."""
    buffer = io.StringIO()
    frame.to_csv(buffer, index=False)
    return buffer.getvalue().encode()
