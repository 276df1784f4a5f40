"""Errors of models of the benchmark against exact solutions: a fast run with a wrong stiffness is
worthless."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from cdem.case.case import Case
from cdem.model.compensation import bonded_tets
from cdem.model.homogenize import means
from cdem.run.simulation import Simulation
from cdem.tools import benchmark_cases as cases


def modulus_error(plain: bool, *, irregular: bool) -> float:
    """Relative error of Young's modulus of a cube of bonded tets in tension along x.

    The modulus is the mean of its inner tets and their faces.

    Args:
        plain: Whether it is `benchmark_cases.plain`.
        irregular: Whether corners of the tets are moved.
    """
    with tempfile.TemporaryDirectory() as place:
        case = cases.pulled_irregular(Path(place)) if irregular else cases.pulled()
        sim = Simulation(Case.from_dict(cases.plain(case) if plain else case), threads=1)
        sim.run()
    (group,) = case["groups"]
    t, made = sim.build.topology, sim.build.compensation.get(group)
    tets = bonded_tets(t, np.arange(len(t.pair_faces)), np.arange(len(t.element_nodes["tet4"])))
    u = sim.fields["displacement"][t.element_nodes["tet4"]].reshape(-1, 12, 1)
    stiffening = 1.0 if made is None else made.stiffening
    strain, stress = means(tets, u, stiffening * 10e9, stiffening * 0.25, tets.inner(2))
    return float((stress[0, 0] - 0.25 * (stress[1, 0] + stress[2, 0])) / strain[0, 0] / 10e9 - 1)


def wave_error(m: int, more: dict[str, Any]) -> float:
    """Relative error of the speed of P waves, by the first mode of the laterally fixed bar.

    Args:
        m: Cells across the bar.
        more: Further keys of its case; see `benchmark_cases.bar`.
    """
    group = {"velocity": [1, 0, 0], "fix": ["y", "z"]}
    sim, _ = cases.start(
        cases.bar(m, "tet4", **{**_copy(more), "group": group}), os.cpu_count() or 1
    )
    x, length = sim.build.start_position[:, 0], 8.0 * m
    weight = sim.fields["mass"] * np.sin(np.pi * x / (2 * length))
    e, nu, rho = 10e9, 0.25, 2500.0
    speed = np.sqrt(e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho)
    crossings: list[float] = []
    before: tuple[float, float] | None = None
    while len(crossings) < 2:
        sim.step(4)
        now = sim.time, float(weight @ sim.fields["displacement"][:, 0])
        if before is not None and before[1] * now[1] < 0:
            crossings.append(before[0] + before[1] / (before[1] - now[1]) * (now[0] - before[0]))
        before = now
    return float(2 * length / (crossings[1] - crossings[0]) / speed - 1)


def _copy(more: dict[str, Any]) -> dict[str, Any]:
    return {key: dict(value) for key, value in more.items()}
