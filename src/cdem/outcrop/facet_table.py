"""Facets as a table, which `cdem joints` reads again, and a case as discs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.joints.directions import dips
from cdem.outcrop.facets import Facets
from cdem.outcrop.survey import OutcropSurvey
from cdem.whole_files import write_text

HEAD = (
    "x,y,z,dip,dip_direction,radius,set,joint,area,strike_length,dip_length,first_end,last_end,"
    "rms,points"
)
"""Columns: centre [m]; dip, dip direction [deg]; radius of the disc of equal area [m]; set, empty for
none, and its joint, counted from 1; area [m2]; extents [m]; ends along strike, `seen` or `open`;
deviation [m]; number of points."""


def write_facets(
    facets: Facets, path: Path, origin: NDArray[np.float64], survey: OutcropSurvey | None
) -> Path:
    """Write facets, with their sets if they are known; returns the path.

    Args:
        facets: About the origin.
        path: The table.
        origin: [m].
        survey: Their sets, or None.

    Raises:
        DiskError: It cannot be written.
    """
    dip, direction = dips(facets.normals)
    rows = [HEAD]
    for k in range(len(facets)):
        x, y, z = facets.centers[k] + origin
        own = ["", "", "", ""]
        if survey is not None:
            ends = ["seen" if seen else "open" for seen in survey.seen[k]]
            own = ["", "", *ends]
            if survey.set_of[k] >= 0:
                name = survey.exposures[survey.set_of[k]].name
                own = [name, str(survey.joint[k] + 1), *ends]
        radius = np.sqrt(facets.areas[k] / np.pi)
        words = [f"{x:.3f},{y:.3f},{z:.3f},{dip[k]:.2f},{direction[k]:.2f},{radius:.4g}"]
        words += [*own[:2], f"{facets.areas[k]:.4g}", *(f"{v:.4g}" for v in facets.lengths[k])]
        words += [*own[2:], f"{facets.rms[k]:.3g}", str(len(facets.members[k]))]
        rows.append(",".join(words))
    write_text(path, "\n".join(rows) + "\n")
    return path
