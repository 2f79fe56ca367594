"""What loggers, bridges and yards call the columns of a trial."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

from shipid.declaration.vocabulary import FIELDS
from shipid.trials.columns import split_header

#: Names in use by field of the vocabulary, in small letters without blanks and signs: English, German, Dutch, Scandinavian, French,
#: Spanish, Italian, Portuguese, Polish, Russian, Turkish, Finnish, Japanese, Chinese and Korean.
_IN_USE: dict[str, str] = {
    "x": "xpositionmid north northing xnorth posnorth positionnorth xpos posx x0 xposition nordwert hochwert",
    "y": "ypositionmid e east easting yeast poseast positioneast ypos posy y0 yposition ostwert rechtswert",
    "psi": "voorliggendekoers kompaskoers gyrokoers gyrokurs rettvisendekurs kurskompass capcompas capgyro capgéographique rumboverdadero rumbogiroscópico rumbocompás psihat heading hdg hdt headingtrue trueheading hdgtrue gyro gyroheading compass compassheading yaw yawangle psi steuerkurs "
    "kompasskurs kompass kreisel kreiselkompass headingtru shipheading vesselheading stevning koers rumbo prora proa capvrai keula "
    "pruva 方位 船首方位 艏向 船首向 航向 선수각 선수방위",
    "r": "tauxgiration bochtsnelheid draaihoeksnelheid wendegeschw drehgeschw vitessedegiration vitessedelacet vitessedevirage tauxdevirage velocidaddeguiñada tasadegiro régimendegiro svingehastighet svingrate girrate girvinkelhastighet dreiehastighet drejehastighed rangvelo rot rateofturn turnrate yawrate yawvelocity rate gyrorate drehrate gierrate wendegeschwindigkeit drehgeschwindigkeit rotation "
    "angvelz rz girhastighet girhastighed draaisnelheid vitessederotation tauxdegiration tauxderotation velocidaddegiro velocitadivirata "
    "角速度 回頭角速度 转首角速度 轉首角速度 회두각속도",
    "u": "loch vitesseloch vitesseauloch vaartdoorhetwater snelheiddoorhetwater vaartdoorwater geschwindigkeitdurchswasser fahrtdurchwasser fahrtdw vitessesurface vitessedansleau velocidadenelagua velocidadporelagua fartgjennomvannet fartgjennomvann fartigennemvandet uvelo stw speedthroughwater waterspeed logspeed surge surgespeed surgevelocity vx fdw fahrtdurchswasser longspeed sogwater",
    "v": "vmvelo sway swayspeed swayvelocity vy transspeed transversespeed",
    "SOG": "vaartoverdegrond vaartovergrond snelheidoverdegrond grondsnelheid fahrtüg geschwindigkeitübergrund vitessefond vitessesurlefond velocidadsobreelfondo velocidadsobrefondo fartovergrunn fartoverbunn fartoverbunden sog speedoverground groundspeed gpsspeed fug fahrtüberground fahrtübergrund vog",
    "COG": "koersoverdegrond koersovergrond grondkoers kursüg routefond routesurlefond capfond rumbosobreelfondo rumbosobrefondo kursovergrunn kursoverbunn beholdtkurs cog courseoverground gpscourse kug kursübergrund trackmadegood tmg",
    "delta": "roerhoekgemeten werkelijkeroerhoek ruderlageist ruderwinkelist anglebarre anglegouvernail angledegouvernail angledesafran barreréelle ángulotimón pala ángulodepala rorutslag roderutslag deltarudder rudder rudderangle rudderfeedback rudderactual rudderposition rudderpos rud rsa ruder ruderwinkel ruderlage ruderistwert "
    "helmangle rorvinkel ror roer roerhoek roerstand delta azimuth azimuthangle azi roder rodervinkel barre angledebarre gouvernail safran "
    "timón timon angulodetimon ángulodetimón timone angolotimone leme angulodeleme ângulodeleme angulodoleme ângulodoleme ster руль рульугол peräsin peräsinkulma dümen dumen 舵角 타각",
    "delta_order": "roergever roerorder roercommando roeropdracht gewensteroerhoek roerhoekgewenst ruderlagesoll ruderwinkelsoll rudersoll rudervorgabe consignedebarre ordredebarre barrecommandée ordendetimón timónordenado rorordre rorkommando beordretrorvinkel rudderorder ruddercommand ruddercmd ruddersetpoint ruddersp rudderdemand orderedrudder commandedrudder rudderset "
    "rudersollwert sollruder ruderbefehl deltaorder deltac deltacmd",
    "n": "asrevoluties schroeftoerental wellendrehz tourshélice régimehélice vitessehélice rpmhélice revoluciones turtall propellturtall akselturtall omdrejninger varvtal nprop rpm shaftrpm propellerrpm proprpm shaftspeed propspeed rev revs revolutions drehzahl wellendrehzahl propellerdrehzahl "
    "omdreiningar toerental",
    "phi": "slingerhoek rolhoek helling krängungswinkel roulis gîte angledegîte escora rulling rullevinkel krengning krengningsvinkel roll rollangle heel heelangle krängung rollwinkel slagside",
    "p": "rollrate rollvelocity rollgeschwindigkeit",
    "wind_speed": "truewindspeed tws windspeedtrue",
    "wind_direction": "truewinddirection twd winddirectiontrue",
    "wind_speed_relative": "relativewindspeed apparentwindspeed aws rws windspeedrelative windspeedapparent",
    "wind_direction_relative": "relativewinddirection apparentwindangle awa rwd relativewindangle winddirectionrelative",
    "thrust": "propellerthrust schub", "torque": "propellertorque shafttorque drehmoment",
    "beta": "drift driftangle driftwinkel",
    "lat": "breedtegraad breitengrad latitud breddegrad lat latitude gpslat breite geographischebreite", "lon": "lengtegraad längengrad longitud lengdegrad længdegrad lon lng long longitude gpslon länge geographischelänge laenge",
}  # fmt: skip
_APART = str.maketrans({"ø": "o", "æ": "ae", "ß": "ss", "ı": "i", "ł": "l", "œ": "oe"})


def _plain(text: str) -> str:
    """A name without accents: loggers leave them out, and files lose them."""
    letters = unicodedata.normalize("NFKD", text.lower().translate(_APART))
    return "".join(c for c in letters if not unicodedata.combining(c))


_FIELDS = {_plain(alias): name for name, aliases in _IN_USE.items() for alias in aliases.split()}
_FIELDS |= {name.lower().replace("_", ""): name for name in FIELDS if name not in ("u", "U", "n", "t")}

#: Names that mean more than one field, and which.
_OPEN: dict[str, tuple[str, ...]] = {
    "speed": ("u", "SOG"), "vesselspeed": ("u", "SOG"), "shipspeed": ("u", "SOG"), "geschwindigkeit": ("u", "SOG"),
    "fahrt": ("u", "SOG"), "fart": ("u", "SOG"), "snelheid": ("u", "SOG"), "velocity": ("u", "SOG"),
    "kurs": ("psi", "COG"), "course": ("psi", "COG"), "cap": ("psi", "COG"), "track": ("COG", "psi"),
    "windspeed": ("wind_speed_relative", "wind_speed"), "winddirection": ("wind_direction_relative", "wind_direction"),
    "windangle": ("wind_direction_relative", "wind_direction"), "enginerpm": ("n",), "enginespeed": ("n",),
    "n": ("n", "x"), "vitesse": ("u", "SOG"), "velocidad": ("u", "SOG"), "velocidade": ("u", "SOG"), "velocità": ("u", "SOG"),
    "velocita": ("u", "SOG"), "prędkość": ("u", "SOG"), "скорость": ("u", "SOG"), "nopeus": ("u", "SOG"), "hız": ("u", "SOG"),
    "船速": ("u", "SOG"), "航速": ("u", "SOG"), "선속": ("u", "SOG"), "rota": ("psi", "COG"), "rotta": ("psi", "COG"), "rumo": ("psi", "COG"),
    "vaart": ("u", "SOG"), "hastighet": ("u", "SOG"), "hastighed": ("u", "SOG"),
    "windsnelheid": ("wind_speed_relative", "wind_speed"), "windrichting": ("wind_direction_relative", "wind_direction"),
    "windgeschwindigkeit": ("wind_speed_relative", "wind_speed"), "windrichtung": ("wind_direction_relative", "wind_direction"),
    "vindhastighet": ("wind_speed_relative", "wind_speed"), "vindretning": ("wind_direction_relative", "wind_direction"),
    "vitesseduvent": ("wind_speed_relative", "wind_speed"), "directionduvent": ("wind_direction_relative", "wind_direction"),
    "velocidaddelviento": ("wind_speed_relative", "wind_speed"), "direccióndelviento": ("wind_direction_relative", "wind_direction"),
    "route": ("COG", "psi"), "курс": ("psi", "COG"), "針路": ("psi", "COG"), "suunta": ("psi", "COG"),
}  # fmt: skip
_AMBIGUOUS = {_plain(name): fields for name, fields in _OPEN.items()}
#: Words at the end of a name that say its unit.
_UNITS = {
    "deg": "deg", "degs": "deg/s", "degmin": "deg/min", "degpermin": "deg/min", "degpersec": "deg/s", "degrees": "deg", "grad": "deg",
    "rad": "rad", "rads": "rad/s", "kn": "kn", "kt": "kn", "kts": "kn", "knots": "kn", "mps": "m/s", "ms": "m/s", "kmh": "km/h",
    "degps": "deg/s", "dps": "deg/s", "degpmin": "deg/min", "rpm": "rpm", "rps": "rps", "m": "m", "meter": "m", "metres": "m", "meters": "m", "knoten": "kn", "nds": "kn",
}  # fmt: skip
#: What a unit holds that stands behind a name without brackets, as in ``Rate °/min``, where no word of it says the unit.
_SIGN = re.compile(r"[°/]")
_SIDE = re.compile(r"(port|ps|pt|stbd|sb|bb|starboard|steuerbord|backbord|1|2|left|right)$")


#: The last part of a path, and what stands before it.
_PATH = re.compile(r"^(.*?[^\W_])\s*([./:>|\\])\s*([^./:>|\\]+)$")
#: What names before a quantity are of the own ship.
_DEVICES = frozenset(
    ("gyro", "compass", "gps", "gnss", "dgps", "nav", "navigation", "ins", "imu", "mru", "ahrs", "ship", "vessel", "own", "ownship", "rudder",
     "steering", "log", "data", "signals", "sensor", "sensors", "measured", "trial", "run", "motion")
)  # fmt: skip


#: Fields without which most commands have nothing to do.
WANTED = ("psi", "r", "u", "delta", "delta_order", "x", "y")


@dataclass(frozen=True)
class Meaning:
    """What a header can mean.

    Attributes
    ----------
    fields : tuple of str
        The fields of the vocabulary, the likeliest first; none, where the name is not in use.
    reason : str
        What says so.
    unit : str or None
        The unit that the name says, as in ``Heading_deg``.
    doubtful : bool
        Whether somebody has to decide which field it is, or whether it is one at all.
    """

    fields: tuple[str, ...]
    reason: str = ""
    unit: str | None = None
    doubtful: bool = False


def meaning_of(header: str) -> Meaning:
    """Return what a header can mean.

    Parameters
    ----------
    header : str
        As it stands in the log.
    """
    name = split_header(header)[0]
    if name in FIELDS:
        return Meaning((name,), "the name of the field itself", _unit_of(name))
    head, _, tail = name.rpartition(" ")
    if head and _SIGN.search(tail) and (found := meaning_of(head)).fields:
        return replace(found, unit=tail)
    words = [word for word in re.split(r"[\W_]+|(?<=[^\W\d_A-Z])(?=[A-Z])", name) if word]
    tail = words[-1].lower() if len(words) > 1 else ""
    unit = _UNITS.get(tail)
    whole, kept = _plain("".join(words)), _plain("".join(words[:-1] if unit else words))
    for text, side in ((whole, ""), (kept, ""), (_SIDE.sub("", kept), " of one side")):
        if text in _AMBIGUOUS:
            fields = _AMBIGUOUS[text]
            doubt = f"can be {' or '.join(fields)}" if len(fields) > 1 else "is not always of the shaft"
            return Meaning(fields, f"'{name}'{side} {doubt}", unit or _unit_of(text), True)
        if text in _FIELDS:
            return Meaning((_FIELDS[text],), f"'{name}' is a usual name{side}", unit or _unit_of(text))
    return _of_a_path(name)


def _of_a_path(name: str) -> Meaning:
    """What a header such as ``Gyro1.Heading`` can mean: of which of several devices it is has to be decided, unless its name says so."""
    found = _PATH.match(name)
    if found is None:
        return Meaning(())
    device, last = found[1].strip(), found[3].strip()
    device = re.sub(r"[\W\d_]+$", "", device)
    whole, own = meaning_of(f"{device} {last}"), meaning_of(last)
    if whole.fields:
        told = f"can be {' or '.join(whole.fields)}" if whole.doubtful else "is a usual name"
        return replace(whole, reason=f"'{name}' {told}")
    if not own.fields:
        return Meaning(())
    known = re.split(r"[\W\d_]+", device.lower())[-1] in _DEVICES
    if known and not own.doubtful:
        return replace(own, reason=f"'{last}' of '{device}' is a usual name")
    return replace(own, reason=f"'{name}' can be {' or '.join(own.fields)}", doubtful=True)


def unread_columns(headers: Iterable[str], known: Collection[str]) -> dict[str, str]:
    """Return columns that are wanted fields under other names, by the field.

    Parameters
    ----------
    headers : iterable of str
        As they stand in the log.
    known : collection of str
        Fields that the log holds.
    """
    found: dict[str, str] = {}
    for header in headers:
        meaning = meaning_of(header)
        field = meaning.fields[0] if meaning.fields and not meaning.doubtful else ""
        if header not in FIELDS and field in WANTED and field not in known:
            found.setdefault(field, header)
    return found


def open_columns(headers: Iterable[str], known: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Return the fields that a column can be, by its header, where one of them is wanted and the log holds none of them.

    Parameters
    ----------
    headers : iterable of str
        As they stand in the log.
    known : collection of str
        Fields that the log holds.
    """
    meanings = {header: meaning_of(header) for header in headers if header not in FIELDS}
    return {
        header: meaning.fields
        for header, meaning in meanings.items()
        if len(meaning.fields) > 1 and set(meaning.fields) & set(WANTED) and not set(meaning.fields) & set(known)
    }


def _unit_of(text: str) -> str | None:
    """The unit that a name itself is."""
    return "rpm" if text.lower().endswith("rpm") else None
