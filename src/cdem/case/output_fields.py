"""The fields of a frame: meaning, unit, place, file and colours of each.

`run/fields.py` computes them. The key `output.fields` of a case, the writers, the pictures and the
table in docs/output_fields.md are made from this list.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cdem.case.laws import STATES

Recorded = Literal["always", "chosen", "leaving", "never"]
"""When a file holds a field: "chosen": `output.fields` of the case names it; "leaving": the case
has `model.domain`, or stages that remove or add groups."""
Colors = Literal["amount", "whole range", "label", "scattered label"]
"""Colours of a field: an amount up to the 99.5th percentile of the last frame, or from 0 to the
largest value; a label by one of few colours, or of many colours that differ between neighbours."""


@dataclass(frozen=True)
class OutputField:
    """One field.

    Attributes:
        name: In cases, files and pictures.
        meaning: Its meaning.
        unit: "1" for a fraction, "" for a number that only tells things apart.
        on: The place of its values. The surface file has values of nodes on its points, and values
        of elements on their faces.
        frames: When frames.vtkhdf holds it; "always" is for fields that do not change.
        surface: When surface.vtkhdf holds it.
        colors: Colours in pictures, or None for no picture.
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
        "peak_velocity", "Largest speed since the last dynamic stage began; only if asked for",
        "m/s", "nodes", frames="chosen", surface="chosen", colors="amount",
    ),
    OutputField(
        "stress", "Mean stress, tension positive: xx yy zz xy yz zx", "Pa", "elements",
        frames="chosen", surface="never", colors=None,
    ),
    OutputField(
        "effective_stress", "Mean stress less the part that pore water carries (biot)", "Pa",
        "elements", frames="chosen", surface="never", colors=None,
    ),
    OutputField(
        "pore_pressure", "Pore pressure, mean of the element", "Pa",
        "elements", frames="chosen", surface="chosen", colors="amount",
    ),
    OutputField(
        "damage", "Broken fraction of an element's bonded faces", "1", "elements",
        frames="chosen", surface="always", colors="whole range",
    ),
    OutputField(
        "slip", "Slip between faces of blocks that met at the start; largest in the element", "m",
        "elements", frames="chosen", surface="chosen", colors="amount",
    ),
    OutputField(
        "opening", "Opening between faces of blocks that met at the start; largest in the element",
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
        "piece", "Lowest block number in the connected piece of the element", "", "elements",
        frames="chosen", surface="always", colors="scattered label",
    ),
    OutputField(
        "out", "1 for an absent block: removed, not yet added, or outside the domain", "",
        "elements", frames="leaving", surface="never", colors=None,
    ),
    OutputField(
        "node", "Number of the node: its row in frames.vtkhdf", "", "nodes",
        frames="never", surface="always", colors=None,
    ),
    OutputField(
        "element", "Number of the face's element: its row in frames.vtkhdf", "",
        "elements", frames="never", surface="always", colors=None,
    ),
    OutputField(
        "face", "Number of the face, the same in all frames", "", "faces",
        frames="never", surface="always", colors=None,
    ),
    OutputField(
        "joint", "Number of the face's joint set, from 1; else 0", "", "faces",
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
    "yielded", "Plastic flow in the element, the sum of 1 shear now, 2 tension now, 4 shear ever, "
    "8 tension ever; 16, 32, 64, 128 likewise for the weak plane", "", "elements",
    frames="chosen", surface="chosen", colors="whole range",
)  # fmt: skip
OUTPUT_FIELDS += [YIELDED]
OUTPUT_FIELDS += [
    OutputField(
        state.name, f"{state.meaning}; largest in the element", state.unit, "elements",
        frames="chosen", surface="chosen", colors="amount",
    )
    for state in STATES.values()
]  # fmt: skip
"""All fields, in the order used everywhere."""

OF_WATER = ("effective_stress", "pore_pressure")
"""Fields that only cases with water have."""
CARRIED = [f for f in OUTPUT_FIELDS if f.surface != "never" and f.on != "faces"]
"""Fields of nodes and elements that the surface file copies to its points and faces."""
CHOICE = [f.name for f in OUTPUT_FIELDS if f.frames == "chosen"]
"""Fields that a case may choose."""
ASKED = ("peak_velocity",)
"""Fields that cost time in every step, and so are not in the default."""
USUAL = [name for name in CHOICE if name not in ASKED]
"""The default."""
