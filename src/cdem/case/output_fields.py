"""The fields of a frame: their meaning, unit and place, which file holds them, how they are coloured.

`run/fields.py` computes them. The key `output.fields` of a case, the writers, the pictures and the
table in docs/output_fields.md follow from the list.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cdem.case.laws import STATES

Recorded = Literal["always", "chosen", "leaving", "never"]
"""When a file holds a field: "chosen" where `output.fields` of the case names it, "leaving" where the
case has `model.domain`, or stages that remove or add groups."""
Colors = Literal["amount", "whole range", "label", "scattered label"]
"""How a field is coloured: an amount up to the 99.5th percentile of the last frame, or from 0 to the
largest value; a label by one of few colours, or of many so that neighbours differ."""


@dataclass(frozen=True)
class OutputField:
    """One field.

    Attributes:
        name: In cases, files and pictures.
        meaning: What it is.
        unit: "1" for a part of something, "" for a number that only tells things apart.
        on: What has a value each. The surface carries values of nodes on its points, and values of
            elements on their faces.
        frames: Whether frames.vtkhdf holds it; "always" are fields that do not change.
        surface: Whether surface.vtkhdf holds it.
        colors: How pictures show it, or None where they do not.
    """

    name: str
    meaning: str
    unit: str
    on: Literal["nodes", "elements", "faces"]
    frames: Recorded
    surface: Recorded
    colors: Colors | None


OUTPUT_FIELDS = [
    OutputField(
        "displacement", "Displacement since the last reset", "m", "nodes",
        frames="chosen", surface="chosen", colors="amount",
    ),
    OutputField(
        "velocity", "Velocity", "m/s", "nodes",
        frames="chosen", surface="chosen", colors="amount",
    ),
    OutputField(
        "stress", "Mean stress, tension positive: xx yy zz xy yz zx", "Pa", "elements",
        frames="chosen", surface="never", colors=None,
    ),
    OutputField(
        "effective_stress", "Mean stress less the part that water in the pores bears (biot)", "Pa",
        "elements", frames="chosen", surface="never", colors=None,
    ),
    OutputField(
        "pore_pressure", "Pressure of the water in the ground, mean of the element", "Pa",
        "elements", frames="chosen", surface="chosen", colors="amount",
    ),
    OutputField(
        "damage", "Broken part of an element's bonded faces", "1", "elements",
        frames="chosen", surface="always", colors="whole range",
    ),
    OutputField(
        "slip", "How far faces of blocks that met at the start have slid; the most in the element", "m",
        "elements", frames="chosen", surface="chosen", colors="amount",
    ),
    OutputField(
        "opening", "How far faces of blocks that met at the start have parted; the most in the element",
        "m", "elements", frames="chosen", surface="chosen", colors="amount",
    ),
    OutputField(
        "group", "Number of the group; the file names the groups", "", "elements",
        frames="always", surface="always", colors="label",
    ),
    OutputField(
        "block", "Number of the block", "", "elements",
        frames="always", surface="always", colors="whole range",
    ),
    OutputField(
        "piece", "Least block that the element hangs together with", "", "elements",
        frames="chosen", surface="always", colors="scattered label",
    ),
    OutputField(
        "out", "1 where the block is not there: dug out, not yet brought in, or left the domain", "",
        "elements", frames="leaving", surface="never", colors=None,
    ),
    OutputField(
        "node", "Number of the node: its row in frames.vtkhdf", "", "nodes",
        frames="never", surface="always", colors=None,
    ),
    OutputField(
        "element", "Number of the element that the face belongs to: its row in frames.vtkhdf", "",
        "elements", frames="never", surface="always", colors=None,
    ),
    OutputField(
        "face", "Number of the face, the same in all frames", "", "faces",
        frames="never", surface="always", colors=None,
    ),
    OutputField(
        "joint", "Number of the set of joints that made the face, from 1; else 0", "", "faces",
        frames="never", surface="always", colors="label",
    ),
    OutputField(
        "broken", "1 where all bonds of the face are broken, 0 on the outside", "", "faces",
        frames="never", surface="always", colors=None,
    ),
    OutputField(
        "water_pressure", "Pressure of the water on the face, mean of its vertices", "Pa", "faces",
        frames="never", surface="always", colors="amount",
    ),
]  # fmt: skip
YIELDED = OutputField(
    "yielded", "What flows in the element now and what ever has, the sum of 1 shear now, 2 tension now, "
    "4 shear ever, 8 tension ever; 16, 32, 64, 128 the same of the weak plane", "", "elements",
    frames="chosen", surface="chosen", colors="whole range",
)  # fmt: skip
OUTPUT_FIELDS += [YIELDED]
OUTPUT_FIELDS += [
    OutputField(
        state.name, f"{state.meaning}; the largest in the element", state.unit, "elements",
        frames="chosen", surface="chosen", colors="amount",
    )
    for state in STATES.values()
]  # fmt: skip
"""In the order in which they are listed everywhere."""

OF_WATER = ("effective_stress", "pore_pressure")
"""Fields that only cases with water have."""
CARRIED = [f for f in OUTPUT_FIELDS if f.surface != "never" and f.on != "faces"]
"""Fields of nodes and elements that the surface carries over to its points and faces."""
CHOICE = [f.name for f in OUTPUT_FIELDS if f.frames == "chosen"]
"""Fields that a case may choose; by default it has all."""
