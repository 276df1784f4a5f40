"""Test of one law: a cube, or a joint between two, along a path of a laboratory test."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS
from cdem.case.reader import read_settings
from cdem.errors import CaseError
from cdem.run.fields import stress_of
from cdem.run.law_fields import state_of
from cdem.run.simulation import Simulation
from cdem.units import to_number

BLOCK_PATHS = {
    "uniaxial": "compression between smooth platens, sides free",
    "tension": "tension between smooth platens, sides free",
    "triaxial": "compression, a pressure on the sides: 'triaxial 5 MPa'",
    "extension": "tension, a pressure on the sides: 'extension 5 MPa'",
    "oedometer": "compression, sides fixed",
}
JOINT_PATHS = {
    "shear": "a joint is sheared under constant pressure: 'shear 1 MPa'",
    "opening": "a joint is pulled open",
}
WITH_PRESSURE = ("triaxial", "extension", "shear")
PULLS = ("tension", "extension")
ROCK = {"density": 2500, "young_modulus": 10e9, "poisson_ratio": 0.25}
"""Default stiffness of a block law, and of the blocks beside a joint."""
SLOW = 4000
"""Duration of a path, in passages of a wave through a block."""
ROWS = 200
STRAIN, WAY = 0.02, 0.01
"""Default end of a path: strain [1]; slip or opening [m]."""


@dataclass(frozen=True)
class Curve:
    """The curve of a test.

    Attributes:
        law: Name.
        path: Path, in the user's words.
        columns: Names with units.
        rows: Values, shape (rows, columns); stresses are positive in tension.
    """

    law: str
    path: str
    columns: list[str]
    rows: NDArray[np.float64]

    def write(self, file: Path) -> Path:
        """Write a CSV file."""
        np.savetxt(file, self.rows, delimiter=",", header=",".join(self.columns), comments="")
        return file

    def draw(self, file: Path) -> Path:
        """Draw the second column, and the states of the law, over the first.

        Raises:
            BackendError: matplotlib is not installed.
        """
        from cdem.output.figures import pyplot

        plt = pyplot()
        states = self.columns[STATES_FROM:]
        figure, axes = plt.subplots(
            1 + bool(states), figsize=(6, 4 + 2 * bool(states)), squeeze=False
        )
        axes[0, 0].plot(self.rows[:, 0], self.rows[:, 1])
        axes[0, 0].set_ylabel(self.columns[1])
        axes[0, 0].set_title(f"{self.law}, {self.path}", fontsize=10)
        for k, name in enumerate(states):
            axes[1, 0].plot(self.rows[:, 0], self.rows[:, STATES_FROM + k], label=name)
        if states:
            axes[1, 0].legend(fontsize=8)
        axes[-1, 0].set_xlabel(self.columns[0])
        figure.tight_layout()
        figure.savefig(file)
        plt.close(figure)
        return file


STATES_FROM = 4
"""Columns of a curve before the states of the law."""


def lead_law(
    name: str,
    path: str,
    settings: Iterable[str] = (),
    *,
    to: float | None = None,
    speed: float | None = None,
) -> Curve:
    """Drive a law along a path.

    Args:
        name: Name of a block or an interface law.
        path: One of `BLOCK_PATHS` or `JOINT_PATHS`, with its pressure if it needs one.
        settings: Texts ``"cohesion=1 MPa"`` that set keys of the material or the interface.
        to: Axial strain [1], or slip or opening [m], at the end.
        speed: Slip rate of a joint [m/s]; by default so slow that inertia does not matter.

    Raises:
        CaseError: No such law or path, or the law refuses its parameters.
    """
    of_block = name in BLOCK_LAWS
    if not of_block and name not in INTERFACE_LAWS:
        known = ", ".join([*BLOCK_LAWS, *INTERFACE_LAWS])
        raise CaseError(f"no law '{name}'; there are: {known}")
    kind, pressure = _read_path(path, BLOCK_PATHS if of_block else JOINT_PATHS, name)
    if of_block and speed is not None:
        raise CaseError("--speed goes with interface laws; block laws do not depend on rate")
    own = read_settings(settings)
    if of_block:
        return _test_block(name, path, kind, pressure, own, STRAIN if to is None else to)
    return _test_joint(name, path, kind, pressure, own, WAY if to is None else to, speed)


def number(option: str, text: str | None, unit: str) -> float | None:
    """The number of an option, positive, with or without a unit.

    Raises:
        CaseError: It is not such a number.
    """
    if text is None:
        return None
    try:
        value = to_number(text, unit)
    except ValueError as error:
        raise CaseError(f"{option} {text}: {error}") from None
    if not value > 0:
        raise CaseError(f"{option} {text}: must be above 0")
    return value


def _read_path(path: str, known: dict[str, str], law: str) -> tuple[str, float]:
    kind, _, rest = path.strip().partition(" ")
    if kind not in known:
        raise CaseError(
            f"no path '{kind}' for the law {law}; there are: "
            + ", ".join(f"{k} ({v})" for k, v in known.items())
        )
    if bool(rest.strip()) != (kind in WITH_PRESSURE):
        wants = f"a pressure: '{kind} 1 MPa'" if kind in WITH_PRESSURE else "no number"
        raise CaseError(f"path {kind} takes {wants}")
    try:
        return kind, to_number(rest.strip(), "Pa") if rest.strip() else 0.0
    except ValueError as error:
        raise CaseError(f"path {path!r}: {error}") from None


def _face(group: str, axis: int, sign: int) -> dict[str, Any]:
    normal = [0, 0, 0]
    normal[axis] = sign
    return {"group": group, "normal": normal}


def _test_block(
    law: str, path: str, kind: str, pressure: float, own: dict[str, Any], to: float
) -> Curve:
    rock = ROCK | own | {"law": law}
    duration = (
        SLOW * (to_number(rock["density"], "kg/m3") / to_number(rock["young_modulus"], "Pa")) ** 0.5
    )
    load = 0.05 * duration if pressure else 0.0
    down = (1 if kind in PULLS else -1) * to / (0.9 * duration)
    wait = [[0.0, 0.0]] + [[load, 0.0]] * bool(load)
    supports = [{"surface": _face("rock", 2, -1), "fix": ["z"]}]
    if kind == "oedometer":
        supports += [
            {"surface": _face("rock", k, n), "fix": ["xy"[k]]} for k in (0, 1) for n in (-1, 1)
        ]
    else:  # fixes edges at the base: a cube with an anisotropic law may lean
        for axis in (0, 1):
            far = [0.1 if k in (axis, 2) else 1.1 for k in range(3)]
            supports.append({"box": {"min": [-0.1] * 3, "max": far}, "fix": ["xy"[axis]]})
    case = Case.from_dict(
        {
            "title": f"{law}, {path}",
            "model": {"blocks": [{"group": "rock", "box": {"size": [1, 1, 1]}}]},
            "materials": {"rock": rock},
            "groups": {"rock": {"material": "rock"}},
            "loads": {
                "supports": supports,
                "tractions": [
                    {"surface": _face("rock", axis, sign), "history": [[0, 0], [load, 1]],
                     "traction": [-sign * pressure if k == axis else 0 for k in range(3)]}
                    for axis, sign in ((0, 1), (0, -1), (1, 1), (1, -1), (2, 1))
                    if kind in WITH_PRESSURE
                ],
                "velocities": [
                    {"surface": _face("rock", 2, 1), "velocity": [0, 0, down], "components": ["z"],
                     "history": wait + [[load + 0.05 * duration, 1]]}
                ],
            },
            "stages": [{"name": "test", "mode": "dynamic", "duration": 1.05 * duration,
                        "damping": {"stiffness": 0.5}}],
            "output": {"frames": False},
        }
    )  # fmt: skip
    sim = Simulation(case, threads=1)

    def row() -> list[float]:
        moved = sim.fields["displacement"]
        top = moved[sim.build.start_position[:, 2] > 0.5, 2].mean()
        far = sim.build.start_position > 0.5
        sides = [moved[far[:, k], k].mean() - moved[~far[:, k], k].mean() for k in (0, 1)]
        stress = stress_of(sim)[0]
        return [top, stress[2], stress[0], sum(sides) + top]

    columns = ["axial strain [1]", "axial stress [Pa]", "lateral stress [Pa]", "volume strain [1]"]
    return _follow(sim, law, path, columns, row, to)


def _test_joint(
    law: str,
    path: str,
    kind: str,
    pressure: float,
    own: dict[str, Any],
    to: float,
    speed: float | None,
) -> Curve:
    duration = SLOW * (ROCK["density"] / ROCK["young_modulus"]) ** 0.5
    speed = to / duration if speed is None else speed
    load = 0.1 * to / speed if pressure else 0.0
    shear = kind == "shear"
    start = [[0, 0], [load, 0], [load + 1e-3 * to / speed, 1]] if pressure else None
    led: list[dict[str, Any]] = [
        {"group": "block", "components": ["x", "y"], "history": start,
         "velocity": [speed if shear else 0, 0, 0]}
    ]  # fmt: skip
    if not shear:
        led.append({"group": "block", "components": ["z"], "velocity": [0, 0, speed]})
    cube = {"size": [1, 1, 1]}
    case = Case.from_dict(
        {
            "title": f"{law}, {path}",
            "model": {"blocks": [
                {"group": "bed", "box": {"size": [3, 3, 1], "divisions": [3, 3, 1]},
                 "translate": [-1, -1, -1]},
                {"group": "block", "box": cube},
            ]},
            "materials": {"rock": ROCK},
            "groups": {"bed": {"material": "rock", "fix": ["x", "y", "z"]}, "block": {"material": "rock"}},
            "interfaces": {"default": own | {"law": law}},
            "loads": {
                "velocities": led,
                "tractions": [{"surface": _face("block", 2, 1), "traction": [0, 0, -pressure],
                               "history": [[0, 0], [0.5 * load, 1]]}] * bool(pressure),
            },
            "stages": [{"name": "test", "mode": "dynamic", "duration": 1.1 * (load + to / speed),
                        "damping": {"mass": 2000.0}}],
            "output": {"frames": False},
        }
    )  # fmt: skip
    sim = Simulation(case, threads=1)
    bed, block = (sim.build.nodes_of(group) for group in ("bed", "block"))

    def row() -> list[float]:
        moved = sim.fields["displacement"][block].mean(axis=0)
        force = -sim.fields["reaction"][bed].sum(axis=0)
        along, up = moved[0], moved[2]
        return [along, force[0], force[2], up] if shear else [up, force[2], force[0], along]

    columns = ["slip [m]", "shear stress [Pa]", "normal stress [Pa]", "opening [m]"]
    if not shear:
        columns = ["opening [m]", "normal stress [Pa]", "shear stress [Pa]", "slip [m]"]
    return _follow(sim, law, path, columns, row, to)


def _follow(sim: Simulation, law: str, path: str, columns: list[str], row: Any, to: float) -> Curve:
    """Rows of a simulation until the first column reaches its end value."""
    own = BLOCK_LAWS.get(law) or INTERFACE_LAWS[law]
    end = sim.case.stages[0].duration
    assert end is not None

    def rows() -> Iterator[list[float]]:
        for k in range(1, ROWS + 1):
            sim.run_until(k * end / ROWS)
            yield [*row(), *(float(state_of(sim, s.name).max()) for s in own.state)]

    found = []
    for one in rows():
        found.append(one)
        if abs(one[0]) >= to:
            break
    names = [f"{s.name} [{s.unit}]" for s in own.state]
    return Curve(law, path, columns + names, np.array(found))
