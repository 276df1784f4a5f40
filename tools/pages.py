"""Run the blocks of pages as a reader would type them, and make the pictures that they show.

`python tools/pages.py docs/tutorials/first_block.md` runs the quick blocks of a page in an empty
folder, in order; `--slow` all of them; `--pictures` all, and makes pictures of docs/pictures/gallery
again: each is the last PNG file that the blocks before it name.

Blocks of `sh` and `python` are run. A comment before a block says what else holds for it:
`<!-- save: NAME -->` writes it to a file, `<!-- slow -->` is run with --slow only, `<!-- not run -->`
never, and `<!-- fails -->` must end with exit status 1.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "pictures" / "gallery"
PART = re.compile(
    r"(?:^<!-- (?P<comment>[^>]*) -->\n\n)?^```(?P<language>\w+)\n(?P<text>.*?)^```$"
    r"|^!\[[^]]*\]\(\S*pictures/gallery/(?P<picture>\w+)\.jpg\)$",
    re.MULTILINE | re.DOTALL,
)
RUN = {"sh": ["bash", "-euc"], "python": [sys.executable, "-c"]}
WIDTH, LARGEST = 1200, 60_000
"""Of pictures [pixels] [bytes]."""


def run_block(command: list[str], folder: Path, expected: int) -> str:
    """Run a block; what it printed."""
    programs = Path(sys.executable).parent
    environment = os.environ | {"PATH": f"{programs}:{os.environ['PATH']}", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode != expected:
        sys.exit(f"{command[-1]}exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def shrink(picture: Path, name: str) -> None:
    """Write a picture for a page: of WIDTH, and at most LARGEST."""
    from PIL import Image

    image = Image.open(picture).convert("RGB")
    image = image.resize((WIDTH, round(image.height * WIDTH / image.width)), Image.LANCZOS)
    file = PICTURES / f"{name}.jpg"
    file.parent.mkdir(exist_ok=True)
    for quality in range(90, 20, -5):
        image.save(file, quality=quality, optimize=True, progressive=True)
        if file.stat().st_size <= LARGEST:
            break
    print(f"{file.relative_to(ROOT)}: {file.stat().st_size} bytes", flush=True)


def run_page(page: Path, folder: Path, *, slow: bool, pictures: bool) -> None:
    """Run the blocks of a page in a folder."""
    (folder / "examples").symlink_to(ROOT / "examples")
    last = ""
    for part in PART.finditer(page.read_text()):
        comment, language, text, picture = part.groups()
        comment = comment or ""
        if picture:
            if pictures and last:
                shrink(folder / last, picture)
            last = ""  # a picture without commands before it is made on another page
        elif comment.startswith("save: "):
            (folder / comment.removeprefix("save: ")).write_text(text)
        elif language in RUN and comment != "not run" and (slow or comment != "slow"):
            printed = run_block([*RUN[language], text], folder, expected=comment == "fails")
            last = next(iter(re.findall(r"^\S+\.png$", printed, re.MULTILINE)[::-1]), last)


def main() -> None:
    """Run the pages that are given."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--slow", action="store_true", help="slow blocks too")
    parser.add_argument("--pictures", action="store_true", help="slow blocks too, and pictures")
    wants = parser.parse_args()
    for page in wants.pages:
        with tempfile.TemporaryDirectory() as folder:
            slow = wants.slow or wants.pictures
            run_page(page, Path(folder), slow=slow, pictures=wants.pictures)


if __name__ == "__main__":
    main()
