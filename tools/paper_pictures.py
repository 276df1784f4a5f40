"""Make the pictures of docs/paper.md: `python tools/paper_pictures.py [PROBLEM]...`.

They are the pictures and plots of the problems of `cdem verify --paper`, as in its report: one file
for each; of a problem with many, one of them all.
"""

import io
import sys
from pathlib import Path

from PIL import Image

from cdem.verification.manual import image
from cdem.verification.runner import problems_of_paper

FOLDER = Path(__file__).resolve().parent.parent / "docs/pictures/paper"
WIDTH = 1200  # of the widest picture  [pixels]
MANY, COLUMNS = 4, 3


def sheet(pictures: list[Image.Image]) -> Image.Image:
    """All pictures in one, row by row."""
    width = WIDTH // COLUMNS
    for picture in pictures:
        picture.thumbnail((width, width))
    rows = -(-len(pictures) // COLUMNS)
    height = max(picture.height for picture in pictures)
    whole = Image.new("RGB", (WIDTH, rows * height), "white")
    for number, picture in enumerate(pictures):
        row, column = divmod(number, COLUMNS)
        whole.paste(picture, (column * width, row * height))
    return whole


def main() -> None:
    """Run the problems, and draw their pictures."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for problem in problems_of_paper():
        if sys.argv[1:] and problem.name not in sys.argv[1:]:
            continue
        shown = problem.run(threads=1).exhibits
        drawn = [Image.open(io.BytesIO(image(exhibit))).convert("RGB") for exhibit in shown]
        for number, picture in enumerate([sheet(drawn)] if len(drawn) > MANY else drawn):
            picture.thumbnail((WIDTH, WIDTH))
            path = FOLDER / f"{problem.name}_{number}.jpg"
            picture.save(path, quality=80, optimize=True)
            print(path, flush=True)


if __name__ == "__main__":
    main()
