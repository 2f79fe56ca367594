"""NMEA 0183 as it is sent: sentences of one time are one sample, each quantity of one source."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import cos, floor, isfinite, nan, pi, sin
from typing import ClassVar

from shipid.declaration import units
from shipid.trials.errors import EmptyFileError
from shipid.trials.logs.clocks.calendar import DAY
from shipid.trials.logs.clocks.course import HOUR, begins_summer, ends_summer
from shipid.trials.logs.clocks.settings import moment_text
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.live.devices import LiveDevices
from shipid.trials.logs.live.table import LiveSample
from shipid.trials.logs.nmea.channels import KNOT
from shipid.trials.logs.nmea.errors import NotNmeaError
from shipid.trials.logs.nmea.log import Origin
from shipid.trials.logs.nmea.sentences.fields import CARRIED
from shipid.trials.logs.nmea.sentences.lines import (
    sentences_of,
    split_line,
    stamp_reader,
    tag_source,
    tag_time,
)
from shipid.trials.logs.nmea.settings import SIGNALS, Calibration, NmeaFormat
from shipid.trials.logs.nmea.sources import answers
from shipid.trials.logs.nmea.streams import part_of

_DEG = pi / 180
#: So many lines without a sentence, and no log is sent.
_PATIENCE = 200
#: How exactly a clock goes back by an hour where summer time ends [s].
_SUMMER = 5.0
#: The signals that are followed.
FOLLOWED = ("psi", "r", "delta", "delta_order", "u", "course", "position", "wind")


class LiveNmea:
    """NMEA 0183 as it is sent.

    Of each signal the first source that is heard is taken, and a better one as soon as it is heard; a sample is what has come
    with one time stamp. Without stamps the time is the UTC of the last fix.

    Parameters
    ----------
    fmt : NmeaFormat
        What the sentences leave open.
    where : str
        The log, for messages.
    tell : callable
        Takes what there is to say of a line.
    origin : tuple of float, optional
        Latitude and longitude in rad from which x and y count; the first fix by default.

    Attributes
    ----------
    names : tuple of str
        The channels that were heard so far, after ``t``.
    kinds : dict of str to tuple of str
        The sentences that a signal may come from, in the order of preference.
    """

    kinds: ClassVar[dict[str, tuple[str, ...]]] = {
        signal: tuple(kind for kind in SIGNALS[signal] if kind in CARRIED) for signal in FOLLOWED
    }

    def __init__(
        self, fmt: NmeaFormat, where: str, tell: Callable[[str], None], origin: tuple[float, float] | None = None
    ) -> None:
        self.names: tuple[str, ...] = ("t",)
        self._fmt, self._where, self._tell = fmt, where, tell
        self._stamp = stamp_reader(fmt.stamp)
        self._source: dict[str, tuple[int, Origin]] = {}
        self._devices: dict[Origin, LiveDevices] = {}
        self._now: float | None = None
        self._origin: float | None = None
        self._added = 0.0
        self._stamped = self._dated = False
        self._sample: dict[str, float] = {}
        self._line = self._sentences = self._lines = 0
        self._place = origin
        self._psi = nan
        self._variation = fmt.variation

    def take(self, number: int, line: str) -> Iterator[LiveSample]:
        """Yield the sample that a line completes: the one before the first sentence of a new time.

        Parameters
        ----------
        number : int
            Of the line, counted from 1.
        line : str
            The line.

        Yields
        ------
        LiveSample

        Raises
        ------
        NotNmeaError
            If none of many lines is a sentence.
        """
        text = line.strip(" \t\r\n\x00\x1a")
        if not text or text.startswith(("#", ";", "//", self._fmt.comment)):
            return
        for piece in sentences_of(text):
            yield from self._take(number, piece)

    def _take(self, number: int, text: str) -> Iterator[LiveSample]:
        self._lines += 1
        sentence = split_line(text)
        if sentence is None:
            if not self._sentences and self._lines > _PATIENCE:
                raise NotNmeaError(
                    f"{self._where} is not an NMEA 0183 log: none of its first {self._lines} lines holds a sentence such as "
                    "$HEHDT,123.4,T*2D."
                )
            self._tell(f"{self._where}, line {number}: no whole sentence; left out.")
            return
        tagged, sound = tag_time(sentence.front) if "\\" in sentence.front else (None, True)
        if not sound or not sentence.whole:
            self._tell(f"{self._where}, line {number}: wrong checksum; left out.")
            return
        self._sentences += 1
        stamp = (
            None if self._fmt.stamp == "none" else tagged or (self._stamp(sentence.front) if sentence.front else None)
        )
        fields = self._fields(number, sentence.text, sentence.address)
        if stamp is not None:
            self._stamped = True
            if stamp.dated:
                self._over_summer_time(number, stamp.time)
            yield from self._passes(number, stamp.time, stamp.dated)
        elif not self._stamped and isfinite(utc := fields.get("utc", nan)):
            day = fields.get("day", nan)
            dated = isfinite(day)
            time = utc + (day * DAY if dated else 0.0)
            if self._now is None:
                self._dated = dated
            elif dated is not self._dated:
                # RMC and ZDA say the date, GGA and GLL do not: the clock runs on as it began, whichever of them comes.
                time += DAY * round((self._now - self._added - time) / DAY)
            yield from self._passes(number, time, dated or self._dated)
        if self._now is not None and fields:
            stream = tag_source(sentence.front) if "\\" in sentence.front else ""
            self._hear(
                self._device(number, Origin(sentence.address[-3:], sentence.address[:-3], stream), fields), fields
            )

    def end(self) -> Iterator[LiveSample]:
        """Yield the last sample.

        Yields
        ------
        LiveSample

        Raises
        ------
        EmptyFileError
            If no sentence had a time.
        """
        if self._now is None:
            raise EmptyFileError(
                f"{self._where} ended before a sentence said its time: {self._sentences} sentences came. A logger's stamp "
                "stands before the sentence; ZDA, RMC, GGA and GLL carry UTC."
            )
        yield from self._emit()

    def _fields(self, number: int, text: str, address: str) -> dict[str, float]:
        """The fields of a sentence that is read here, by name."""
        kind = address[-3:]
        if kind not in CARRIED or text[0] != "$" or address[0] == "P":
            return {}
        try:
            return dict(zip(CARRIED[kind][0], CARRIED[kind][1](text.split(","))))
        except ValueError:
            self._tell(f"{self._where}, line {number}: the fields of {kind} are no numbers; left out.")
            return {}

    def _over_summer_time(self, number: int, time: float) -> None:
        """Let the local stamps of a logger run on where summer time ends or begins."""
        before = None if self._now is None else self._now - self._added
        if before is None or not ends_summer(before):
            return
        hour = (
            HOUR
            if abs(time - before + HOUR) <= _SUMMER
            else -HOUR
            if begins_summer(floor(before), floor(time))
            else 0.0
        )
        if hour:
            self._added += hour
            way = "back by an hour, where summer time ends" if hour > 0 else "on by an hour, where summer time begins"
            self._tell(f"{self._where}, line {number}: the clock goes {way}: it was let run on.")

    def _passes(self, number: int, time: float, dated: bool) -> Iterator[LiveSample]:
        """Go on to a time; the sample of the time before is complete."""
        time += self._added
        if not dated and self._now is not None and time - self._now < -DAY / 2:
            self._added += DAY
            time += DAY
            self._tell(f"{self._where}, line {number}: The clock passes midnight.")
        if self._now is not None and time != self._now:
            yield from self._emit()
        if self._origin is None:
            self._origin = time
            moment = moment_text(time, "") if dated and time > 366 * DAY else f"{time:.3f} s of the clock"
            self._tell(f"{self._where}, line {number}: t = 0 is {moment}.")
        self._now, self._line = time, number

    def _emit(self) -> Iterator[LiveSample]:
        if not self._sample or self._now is None or self._origin is None:
            return
        self.names += tuple(name for name in self._sample if name not in self.names)
        yield LiveSample(self._line, {"t": round(self._now - self._origin, 6), **self._sample})
        self._sample = {}

    def _device(self, number: int, origin: Origin, fields: dict[str, float]) -> Origin:
        """The device that a sentence comes from, where several share its talker."""
        assert self._now is not None
        devices = self._devices.setdefault(origin, LiveDevices(origin))
        known = devices.count
        device = devices.heard(self._now, fields)
        if devices.count == 1:
            return origin
        first = part_of(origin, 0)
        if known == 1:
            self._source = {s: (rank, first if o == origin else o) for s, (rank, o) in self._source.items()}
            self._tell(
                f"{self._where}, line {number}: WARNING: {origin.name} comes from {devices.count} devices that share a talker, "
                f"{devices.apart} apart. They are kept apart from here on, and {first.name} is taken; [nmea.sources] of a format file "
                f"says which one, as in '{part_of(origin, 1).name}'."
            )
        return part_of(origin, device)

    def _hear(self, origin: Origin, fields: dict[str, float]) -> None:
        """Put what a sentence says into the sample, where it is the source of the signal."""
        kind = origin.kind
        if (
            kind in ("HDG", "RMC", "127250", "127258")
            and self._fmt.variation is None
            and isfinite(fields.get("variation", nan))
        ):
            self._variation = fields["variation"] * _DEG
        for signal, kinds in self.kinds.items():
            if kind not in kinds or signal in self._fmt.leave_out:
                continue
            found = self._read(signal, kind, fields)
            if not found or not self._is_source(signal, origin):
                continue
            self._sample |= found

    def _is_source(self, signal: str, origin: Origin) -> bool:
        wanted, kind = self._fmt.sources.get(signal), origin.kind
        if wanted is not None:
            return answers(origin, wanted)
        order = list(self.kinds[signal])
        if signal == "psi" and kind in CARRIED and self._fmt.reference == "magnetic":
            order = ["HDG", "HDM", "THS", "HDT", "VHW"]
        source = (order.index(kind), origin)
        best = self._source.get(signal)
        if best is None or source[0] < best[0]:
            self._source[signal] = source
            self._tell(f"{self._where}: {signal} is of {origin.name}.")
            return True
        return source == best

    def _read(self, signal: str, kind: str, fields: dict[str, float]) -> dict[str, float]:
        """What a sentence says of a signal, SI; nothing where it is not valid."""
        fmt = self._fmt
        if signal == "psi":
            psi = fields["heading"] * _DEG + fmt.correction
            if kind in ("HDG", "HDM") and self._variation is not None:
                psi += self._variation
            self._psi = psi if isfinite(psi) else self._psi
            return _there(psi=psi)
        if signal == "r":
            return _there(r=fields["rate"] * fmt.rate_sign * units.factor(fmt.rate_unit, "rad/s"))
        if signal in ("delta", "delta_order"):
            return _there(**{signal: _angle(fields, fmt.rudder if signal == "delta" else fmt.order)})
        if signal == "u":
            ground = "_ground" if fmt.speed == "ground" and kind == "VBW" else ""
            return _there(u=fields.get("u" + ground, nan) * KNOT, v=fields.get("v" + ground, nan) * KNOT)
        if signal == "course" and kind != "VBW":
            return _there(SOG=fields["sog"] * KNOT, COG=fields["cog"] * _DEG)
        if signal == "position" and isfinite(fields["lat"]) and isfinite(fields["lon"]):
            return self._metres(fields["lat"] * _DEG, fields["lon"] * _DEG)
        if signal == "wind":
            return self._wind(fields)
        return {}

    def _wind(self, fields: dict[str, float]) -> dict[str, float]:
        """The relative wind, or the true one, whose angle counts from the bow: by the directions they blow to."""
        return _there(
            wind_speed_relative=fields["speed"] * KNOT,
            wind_direction_relative=fields["angle"] * _DEG + pi,
            wind_speed=fields["true_speed"] * KNOT if isfinite(self._psi) else nan,
            wind_direction=fields["true_angle"] * _DEG + pi + self._psi,
        )

    def _metres(self, lat: float, lon: float) -> dict[str, float]:
        """North and east of the first fix, of midship where the antenna is stated."""
        if self._place is None:
            self._place = (lat, lon)
            self._tell(f"{self._where}: x, y are metres from latitude {lat / _DEG:.7f}, longitude {lon / _DEG:.7f}.")
        north, east = (float(v) for v in to_local(lat, lon, self._place))
        if self._fmt.antenna is not None and isfinite(self._psi):
            from_midship = complex(*self._fmt.antenna)
            turned = from_midship * complex(cos(self._psi), sin(self._psi))
            north, east = north - turned.real, east - turned.imag
        return {"x": north, "y": east}


def _there(**values: float) -> dict[str, float]:
    return {name: value for name, value in values.items() if isfinite(value)}


def _angle(fields: dict[str, float], calibration: Calibration) -> float:
    """Rudder angle of RSA or ROR, of the side that is wanted or there."""
    starboard, port = fields["starboard"], fields["port"]
    if calibration.use == "mean":
        number = 0.5 * (starboard + port)
    elif calibration.use == "port" or (calibration.use is None and not isfinite(starboard)):
        number = port
    else:
        number = starboard
    return calibration.sign * (calibration.scale * number + calibration.offset)
