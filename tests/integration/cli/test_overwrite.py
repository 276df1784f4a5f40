"""`--overwrite` knows every file that a command writes into a result folder."""

from __future__ import annotations

import pytest

from cdem.case.stored import MARKER
from cdem.output.render import can_draw

pytestmark = pytest.mark.usefixtures("cube_folder")
COMMANDS = (
    ("plot",),
    ("export",),
    ("runout", "--direction", "90", "--section", "0.5,-1,0.5,2"),
    ("render", "--movie"),
    ("render", "--field", "velocity_z", "--slice", "y=0.4", "--before-after", "--movie"),
    ("render", "--slice", "0,0.4,1,0.6", "--time", "0"),
)


def test_what_all_commands_write_is_replaced(run_cli, cube_folder):
    settings = (
        "--set",
        "output.fields=[displacement, velocity, piece]",
        "--set",
        "output.every=5 ms",
    )
    assert run_cli("run", "cube.yaml", "-o", "out", *settings)[0] == 0
    for command, *options in COMMANDS:
        if command != "render" or can_draw():
            assert run_cli(command, "out", *options)[0] == 0
    assert run_cli("run", "cube.yaml", "-o", "out", "--overwrite", "--quiet") == (0, "", "")
    left = {path.name for path in (cube_folder / "out").iterdir()}
    assert MARKER in left and not any(name.endswith((".png", ".gif", ".asc")) for name in left)
