"""Fail when a core file includes one from a layer above its own, or when includes nest too deep."""

import re
import sys
from functools import cache
from pathlib import Path

LAYERS = """launch math field measure
            materials interfaces elements contact nodes
            model state columns
            backend
            step check start refresh hand_over surface exposed patch_pair near_edges proximity candidates close_lists edge_list rest free_blocks""".splitlines()
DEEPEST = 10


def layer(path: str) -> int:
    """Height of the layer that a file of core/ belongs to."""
    name = path.split("/")[1].split(".")[0]
    for height, names in enumerate(LAYERS):
        if name in names.split():
            return height
    sys.exit(f"{path}: give it a place in LAYERS")


@cache
def depth(path: str) -> int:
    """Length of the longest chain of includes from a file down."""
    layer(path)  # a file that includes nothing needs its place too
    below = re.findall(r'#include "(core/[^"]+)"', Path(path).read_text())
    for other in below:
        if layer(other) > layer(path):
            sys.exit(f"{path} may not include {other}, which lies above it")
    return 1 + max(map(depth, below), default=0)


sources = [path for ending in ("*.[hc]pp", "*.cu") for path in sorted(Path("core").rglob(ending))]
deepest = max(depth(str(path)) for path in sources)
sys.exit(f"includes are {deepest} deep, more than {DEEPEST}" if deepest > DEEPEST else 0)
