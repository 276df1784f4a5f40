"""Output fields: the case, the documents and the pictures follow from one list."""

import subprocess
import sys
from pathlib import Path

from cdem import Case
from cdem.case.output_fields import CHOICE, OUTPUT_FIELDS

ROOT = Path(__file__).parents[3]


def test_the_case_offers_the_fields_of_frames():
    output = Case.schema()["$defs"]["Output"]["properties"]["fields"]
    assert output["items"]["enum"] == CHOICE
    assert output["default"] == [name for name in CHOICE if name != "peak_velocity"]
    assert CHOICE == [
        "displacement", "velocity", "peak_velocity", "stress", "effective_stress", "pore_pressure", "damage", "slip", "opening", "piece",
        "yielded", "plastic_shear", "plastic_tension", "joint_plastic_shear", "joint_plastic_tension",
        "joint_slip", "joint_damage", "joint_opening", "joint_reversal", "joint_unloads"
    ]  # fmt: skip


def test_names_are_unique_and_the_table_of_the_documents_is_up_to_date():
    assert len({field.name for field in OUTPUT_FIELDS}) == len(OUTPUT_FIELDS)
    tool = [sys.executable, str(ROOT / "tools" / "tables.py"), "--check"]
    assert subprocess.run(tool, check=False).returncode == 0
