"""Conventions for planes in tables: dip with dip direction or strike, poles, normals; five languages."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints import bearings
from cdem.joints.directions import dips, line
from cdem.joints.tables import Table, plain

Floats = NDArray[np.float64]

NAMES: dict[str, tuple[str, ...]] = {
    "dip": (
        "dip",
        "dip_angle",
        "dip_amount",
        "true_dip",
        "angle",
        "slope",
        "slopeangle",
        "inclination",
        *("einfallen", "einfallwinkel", "einfallswinkel", "fallwinkel", "fallen", "neigung"),
        *("pendage", "inclinaison", "angle_de_pendage", "angle_pendage"),
        *("inclinazione", "angolo_di_inclinazione", "angolo_d_inclinazione"),
        *("buzamiento", "inclinacion", "manteo", "echado", "angulo_de_buzamiento"),
        *("倾角",),
    ),
    "dip_direction": (
        "dip_direction",
        "dip_dir",
        "dipdirection",
        "dipdir",
        "dip_azimuth",
        "dipazimuth",
        "dir",
        "direction",
        "azimuth",
        "azimut",
        "azi",
        "dd",
        "ddr",
        *("fallrichtung", "einfallrichtung", "einfallsrichtung", "fallazimut", "einfallazimut"),
        *("direction_de_pendage", "direction_du_pendage", "direction_pendage"),
        *("azimut_de_pendage", "azimut_du_pendage", "azimut_pendage"),
        *("immersione", "direzione_di_immersione", "direzione_d_immersione", "azimut_immersione"),
        *("direccion_de_buzamiento", "direccion_buzamiento", "azimut_de_buzamiento"),
        *("direccion_de_manteo", "azimut_buzamiento"),
        *("倾向",),
    ),
    "strike": (
        "strike",
        "strike_azimuth",
        "strike_rhr",
        "rhr_strike",
        "right_hand_strike",
        "strike_right",
        "strike_lhr",
        "lhr_strike",
        "left_hand_strike",
        "strike_left",
        *("streichen", "streichrichtung", "streichwinkel"),
        *("direction_de_la_couche", "azimut_de_la_direction"),
        *("rumbo", "direccion_de_rumbo"),
        *("走向",),
    ),
    "quadrant": (
        "dip_quadrant",
        "quadrant",
        "quad",
        "dip_quad",
        "dip_side",
        "dip_sense",
        *("einfallquadrant", "sens_de_pendage", "sens_du_pendage", "sens_pendage", "sens"),
        *("quadrante", "cuadrante", "sentido", "sentido_de_buzamiento", "verso"),
        *("象限", "倾向象限"),
    ),
    "attitude": (
        "attitude",
        "orientation",
        "strike_dip",
        "dip_direction_dip",
        "dipdir_dip",
        "dip_dip_direction",
        "dip_dipdir",
        *("raumlage", "orientierung", "giacitura", "orientacion", "产状"),
    ),
    "pole_trend": ("pole_trend", "trend_of_pole", "pole_azimuth", "poltrend", "polazimut"),
    "pole_plunge": ("pole_plunge", "plunge_of_pole", "pole_dip", "poleinfallen"),
    "trend": ("trend",),
    "plunge": ("plunge",),
    "nx": ("nx", "n_x", "normal_x", "normalx"),
    "ny": ("ny", "n_y", "normal_y", "normaly"),
    "nz": ("nz", "n_z", "normal_z", "normalz"),
}
"""Quantities of columns, and their possible headings, in the form of `plain`."""
DOUBTFUL = {"direccion", "direzione", "richtung", "direction"}
"""Headings for strike or dip direction; English `direction` is the latter."""
UNDERSTOOD = (
    "dip and dip_direction (or strike, with a quadrant or by the right or left hand), pole_trend and "
    "pole_plunge, or nx, ny, nz"
)
ANGLES = {"": 1.0, "deg": 1.0, "degree": 1.0, "degrees": 1.0, "°": 1.0, "gon": 0.9}
ANGLES["rad"] = 180 / np.pi
NO_ANGLES = {"grad", "grads", "grades", "mil", "mils", "%", "percent"}
FARTHEST = 75.0
"""Largest deviation of a plane's dip from the quadrant in its row, else the row is in doubt [deg]."""
_EAST = re.compile(r"einfall|fallrichtung|fallwinkel|streich|neigung")
_WEST = re.compile(r"pendage|inclin|immersione|buzamiento|rumbo|manteo|cuadrante|quadrante|verso")
_CHINESE = str.maketrans("北东南西", "NESW")


def is_heading(words: list[str]) -> bool:
    """Whether some words name columns of planes."""
    names = {plain(word) for word in words}
    keys = {key for key, known in NAMES.items() if names & set(known)}
    poles = {"trend", "plunge"} <= names or {"pole_trend", "pole_plunge"} <= keys
    direction = keys & {"dip_direction", "strike"} or names & DOUBTFUL
    return bool(
        ("dip" in keys and direction) or poles or {"nx", "ny", "nz"} <= keys or "attitude" in keys
    )


def read_attitudes(table: Table) -> tuple[Floats, Floats, set[str]]:
    """Dip and dip direction [deg] of the planes of a table, and the columns used.

    Notes of the table report a convention that had to be assumed.

    Raises:
        CaseError: No convention fits the columns, a value is out of range, or a row contradicts
            itself; names the place.
    """
    if not table.head:
        _guess_columns(table)
    else:
        _quadrants_first(table)
        _doubtful(table)
        table.find(NAMES)
    at = table.at
    if "dip" in at and {"dip_direction", "strike"} & at.keys():
        return _dipping(table)
    if "attitude" in at:
        return _pairs(table)
    if {"nx", "ny", "nz"} <= at.keys():
        normals = np.column_stack([_values(table, key) for key in ("nx", "ny", "nz")])
        size = np.linalg.norm(normals, axis=1)
        if not size.all():
            raise CaseError(f"{table.path}:{table.lines[size.argmin()]}: the normal is 0, 0, 0")
        return *dips(normals / size[:, None]), {"nx", "ny", "nz"}
    for trend, plunge in (("pole_trend", "pole_plunge"), ("trend", "plunge")):
        if {trend, plunge} <= at.keys() and "dip" not in at:
            table.notes.append("trend and plunge describe poles: dip = 90 - plunge")
            poles = line(azimuths(table, trend), angles(table, plunge, -90, 90))
            return *dips(poles), {trend, plunge}
    if ("trend" in at) != ("plunge" in at):
        raise CaseError(f"{table.path}: lines need both columns, trend and plunge")
    present = ", ".join(table.head) or f"{len(table.rows[0])} columns without names"
    raise CaseError(
        f"{table.path}: the first line must name the columns {UNDERSTOOD}; it has: {present}"
    )


def angles(table: Table, key: str, low: float, high: float) -> Floats:
    """A column of angles [deg] within a range.

    Raises:
        CaseError: A value is not a number, or out of range; names the place.
    """
    values = np.array([bearings.angle(word) for word in table.column(key)]) * _unit(table, key)
    _refuse(table, key, ~((values >= low) & (values <= high)), f"a number from {low:g} to {high:g}")
    return values


def azimuths(table: Table, key: str) -> Floats:
    """A column of directions [deg], 0 to 360; up to one full turn beyond is corrected.

    Raises:
        CaseError: A value is not a number, or out of range; names the place.
    """
    words = _compass(table, key)
    values = np.array([bearings.azimuth(word) for word in words]) * _unit(table, key)
    _refuse(table, key, ~((values >= -360) & (values <= 720)), "a number from 0 to 360")
    if over := int(((values < 0) | (values > 360)).sum()):
        table.notes.append(f"{table.name(key)}: {over} outside 0 to 360, corrected by full turns")
    return np.where((values < 0) | (values > 360), values % 360, values)


def _values(table: Table, key: str) -> Floats:
    values = table.numbers(key)
    _refuse(table, key, ~np.isfinite(values), "a number")
    return values


def _refuse(table: Table, key: str, wrong: NDArray[np.bool_], allowed: str) -> None:
    """Refuse the first row in which a column is wrong."""
    if wrong.any():
        row = int(wrong.argmax())
        raise CaseError(
            f"{table.path}:{table.lines[row]}: {table.name(key)} must be {allowed}, got "
            f"'{table.column(key)[row]}'"
        )


def _unit(table: Table, key: str) -> float:
    """Factor to degrees for a heading's unit; the hand rule has no unit."""
    if key == "strike" and _hand(table):
        return 1.0
    return table.factor(key, ANGLES, NO_ANGLES)


def _compass(table: Table, key: str) -> list[str]:
    """Words of a column, with Chinese, German and Romance points of the compass in English.

    Raises:
        CaseError: O means east in German and west in French; here it is ambiguous.
    """
    words = [re.sub(r"\b([EW])([NS])\b", r"\2\1", w.translate(_CHINESE)) for w in table.column(key)]
    if not any("O" in word.upper() for word in words):
        return words
    heads = " ".join(plain(name) for name in table.head)
    east, west = bool(_EAST.search(heads)), bool(_WEST.search(heads))
    if east == west:
        has = np.array(["O" in word.upper() for word in words])
        _refuse(table, key, has, "a bearing with N, E, S, W (O is east or west)")
    letter = "E" if east else "W"
    return [re.sub("o", letter, word, flags=re.IGNORECASE) for word in words]


def _quadrants_first(table: Table) -> None:
    """Make a column of compass points beside a numeric direction the quadrants."""
    names = [plain(name) for name in table.head]
    for i, name in enumerate(names):
        if name not in NAMES["dip_direction"]:
            continue
        words = [row[i].translate(_CHINESE) for row in table.rows if row[i]]
        if not words or any(
            bearings.wind(word.upper().replace("O", "E")) is None for word in words
        ):
            continue
        for k, other in enumerate(names):
            if k != i and (
                other in DOUBTFUL or other in (*NAMES["dip_direction"], *NAMES["strike"])
            ):
                table.at |= {"quadrant": i, "strike": k}
                if other not in NAMES["strike"]:
                    table.notes.append(
                        f"{table.head[k]} is taken as strike: {table.head[i]} has quadrants"
                    )
                return


def _doubtful(table: Table) -> None:
    """Take a column that may be strike or dip direction as strike if there are quadrants, else refuse."""
    names = [plain(name) for name in table.head]
    sure = {*NAMES["dip_direction"], *NAMES["strike"]} - DOUBTFUL
    foreign = set(NAMES["dip"][8:]) & set(names)
    for i, name in enumerate(names):
        if "strike" in table.at or name not in DOUBTFUL or sure & set(names):
            continue
        if name == "direction" and not foreign:
            continue
        sided = any(bearings.sided(row[k])[1] for row in table.rows[:1] for k in range(len(row)))
        if not sided and not set(NAMES["quadrant"]) & set(names):
            raise CaseError(
                f"{table.path}: {table.head[i]!r} may be strike or dip direction; call it strike or "
                "dip_direction"
            )
        table.at["strike"] = i


def _guess_columns(table: Table) -> None:
    """Table without names: one column of attitudes, or two, one of which exceeds 90 or has
    bearings.

    Raises:
        CaseError: The columns are ambiguous.
    """
    width = len(table.rows[0])
    if width == 1 and bearings.pair(table.rows[0][0]):
        table.at["attitude"] = 0
    elif width == 2:
        _guess_two(table)
    if not table.at:
        raise CaseError(
            f"{table.path}: has no line of names, and {width} columns that may be many things; name "
            f"{UNDERSTOOD} in its first line"
        )
    what = {i: key.replace("_", " ") for key, i in table.at.items()}
    named = ", ".join(f"column {i + 1} is {what[i]}" for i in sorted(what))
    table.notes.append(f"no line of names: {named}")


def _guess_two(table: Table) -> None:
    """The dip among two columns, if it is clear."""
    columns = [[row[i] for row in table.rows] for i in range(2)]
    bearing = [any(re.match("[NESW]", w, re.IGNORECASE) for w in words) for words in columns]
    sided = [any(bearings.sided(word)[1] for word in words) for words in columns]
    steep = [any(bearings.sided(word)[0] > 90 for word in words) for words in columns]
    if bearing[0] != bearing[1] or sided[0] != sided[1]:
        dip = 1 if bearing[0] or sided[1] else 0
        table.at |= {"dip": dip, "strike": 1 - dip}
    elif steep[0] != steep[1]:
        table.at |= {"dip": int(steep[0]), "dip_direction": int(steep[1])}


def _pairs(table: Table) -> tuple[Floats, Floats, set[str]]:
    """Attitudes of one column: `N45E 40SE`, `120/40`."""
    halves = [bearings.pair(word) for word in table.column("attitude")]
    _refuse(
        table, "attitude", np.array([h is None for h in halves]), "two angles: N45E 40SE, 120/40"
    )
    rows = [list(h) for h in halves if h is not None]
    name = plain(table.head[table.at["attitude"]]) if table.head else ""
    first = name.split("_")[0]
    parts = Table(table.path, [], rows, table.lines, table.notes)
    if name.startswith("dip_d") and name.endswith("_dip"):
        parts.at = {"dip_direction": 0, "dip": 1}
    elif name in ("dip_dip_direction", "dip_dipdir"):
        parts.at = {"dip": 0, "dip_direction": 1}
    elif first in ("dipdir", "strike"):
        parts.at = {"dip_direction" if first == "dipdir" else "strike": 0, "dip": 1}
    else:
        _guess_columns(parts)
    dip, direction, _ = _dipping(parts)
    return dip, direction, {"attitude"}


def _dipping(table: Table) -> tuple[Floats, Floats, set[str]]:
    """Dip with dip direction or strike; sides are beside the dip or in a column of quadrants."""
    found = [bearings.sided(word) for word in _compass(table, "dip")]
    dip = np.array([value for value, _ in found]) * _unit(table, "dip")
    _refuse(table, "dip", ~((dip >= 0) & (dip <= 90)), "a number from 0 to 90")
    key = "dip_direction" if "dip_direction" in table.at else "strike"
    direction = azimuths(table, key)
    sides = [side for _, side in found]
    where = _sides(table, sides)
    if key == "strike":
        direction = _of_strike(table, direction, where, dip)
    elif all(bearings.wind(word) is not None for word in table.column(key)):
        table.notes.append(f"{table.name(key)} has compass points only: SE is 135")
    off = np.abs((direction - where + 180) % 360 - 180)
    wrong = (off > FARTHEST) & (dip > 0) & (dip < 90)
    if wrong.any():
        row = int(wrong.argmax())
        raise CaseError(
            f"{table.path}:{table.lines[row]}: {key.replace('_', ' ')} '{table.column(key)[row]}' "
            f"and the side '{sides[row]}' contradict each other"
        )
    used = {"dip", key} | ({"quadrant"} & table.at.keys())
    return dip, direction % 360 if key == "strike" else direction, used


def _sides(table: Table, sides: list[str]) -> Floats:
    """Directions of dip from quadrants [deg], NaN without one; ``sides`` become words."""
    if "quadrant" in table.at:
        words = _compass(table, "quadrant")
        sides[:] = [word.strip().upper() or side for word, side in zip(words, sides, strict=True)]
    where = np.array([np.nan if (w := bearings.wind(s)) is None else w for s in sides])
    unknown = np.array([bool(side) for side in sides]) & np.isnan(where)
    _refuse(table, "quadrant" if "quadrant" in table.at else "dip", unknown, "N, NE, E, ... NW")
    return where


def _of_strike(table: Table, strike: Floats, where: Floats, dip: Floats) -> Floats:
    """Dip directions of strikes [deg], towards the given sides, or by a hand rule."""
    if np.isnan(where).all():
        words = [word.upper() for word in _compass(table, "strike")]
        bearing = np.array([word[:1] in ("N", "E", "S", "W") for word in words])
        folded = any("W" in word for word in words) or strike.max() <= 180
        if folded and not _hand(table):
            _refuse(table, "strike", bearing, "beside a dip with its side, as 40SE")
        left = _hand(table) == "left"
        rule, sign = ("left-hand", "-") if left else ("right-hand", "+")
        table.notes.append(f"strike is taken by the {rule} rule: dip direction = strike {sign} 90")
        return (strike + (-90 if left else 90)) % 360
    missing = np.isnan(where) & (dip > 0) & (dip < 90)
    if missing.any():
        row = int(missing.argmax())
        raise CaseError(
            f"{table.path}:{table.lines[row]}: gives no side of the dip, but other rows do; add it"
        )
    right = (strike + 90) % 360
    off = np.abs((right - where + 180) % 360 - 180)
    return np.where(off <= 90, right, (strike - 90) % 360)


def _hand(table: Table) -> str:
    """The hand rule in a heading of strikes: left, right, or none."""
    name = table.head[table.at["strike"]].lower() if table.head else ""
    if re.search(r"lhr|left|links|linke|gauche|sinistra|izquierda|左", name):
        return "left"
    return "right" if re.search(r"rhr|right|recht|droite|destra|derecha|右", name) else ""
