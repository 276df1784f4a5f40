"""Check that what describes the package says what pyproject.toml says.

The conda recipe, the Dockerfile, the workflows, CMakeLists.txt, CITATION.cff, tools/setup.sh and
docs/install.md: version, Python versions, dependencies, extras and system libraries.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from ruamel.yaml import YAML

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # scikit-build-core brings it

ROOT = Path(__file__).resolve().parent.parent
FACTS = tomllib.loads((ROOT / "pyproject.toml").read_text())
PROJECT = FACTS["project"]
LEAST = PROJECT["requires-python"].removeprefix(">=")
BUILT = re.findall(r"cp3(\d+)-", FACTS["tool"]["cibuildwheel"]["build"])
"""Minor versions of Python that wheels are built for."""
OF_MACHINE = {"cmake", "ninja"}
"""What conda takes from the machine that builds; all else belongs to the environment of the package."""
LIBRARIES = "libosmesa6 libgl1 libxrender1"
"""What draws pictures without a screen."""


def read(path: str) -> str:
    """Text of a file."""
    return (ROOT / path).read_text()


def spaced(requirements: list[str]) -> set[str]:
    """Requirements as conda writes them."""
    return {re.sub(r"([<>=])", r" \1", one, count=1) for one in requirements}


def plain(requirements: list) -> set[str]:
    """Requirements of conda without those that depend on the system or are compilers."""
    return {one for one in requirements if isinstance(one, str) and "{{" not in one}


def recipe() -> Iterator[str]:
    """Differences of the conda recipe."""
    told = YAML(typ="safe").load(ROOT / "packaging/conda/recipe.yaml")
    python, needs = f"python >={LEAST}", told["requirements"]
    tools = FACTS["build-system"]["requires"]
    of_machine = [one for one in tools if one.split(">")[0] in OF_MACHINE]
    of_package = [one for one in tools if one not in of_machine]
    commands = [f"{name} = {place}" for name, place in PROJECT["scripts"].items()]
    pairs = {
        "version": (told["context"]["version"], PROJECT["version"]),
        "summary": (told["about"]["summary"], PROJECT["description"]),
        "licence": (told["about"]["license"], PROJECT["license"]["text"]),
        "commands": (told["build"]["python"]["entry_points"], commands),
        "run": (plain(needs["run"]), {python} | spaced(PROJECT["dependencies"])),
        "build": (plain(needs["build"]), spaced(of_machine)),
        "host": (plain(needs["host"]), {python, "pip"} | spaced(of_package)),
    }
    return (name for name, (here, there) in pairs.items() if here != there)


def dockerfile() -> Iterator[str]:
    """Differences of the Dockerfile."""
    text = read("Dockerfile")
    if any(minor not in BUILT for minor in re.findall(r"FROM python:3\.(\d+)", text)):
        yield "a Python that no wheel is built for"
    images = set(re.findall(r"FROM (\S+)", text))
    if len(images) != 1:
        yield f"images of build and run differ: {', '.join(sorted(images))}"
    if LIBRARIES not in text:
        yield f"lacks {LIBRARIES}"
    extras = re.findall(r"\.whl\)\[([\w,]+)\]", text)[0].split(",")
    if unknown := set(extras) - set(PROJECT["optional-dependencies"]):
        yield f"no such extra: {', '.join(unknown)}"
    named = re.findall(r"The image has the extras ([^.;]+);", read("docs/install.md"))
    if [re.findall(r"`(\w+)`", one) for one in named] != [extras]:
        yield "docs/install.md names other extras"


def workflows() -> Iterator[str]:
    """Differences of the workflows."""
    if f'python: ["{LEAST}"' not in read(".github/workflows/test.yml"):
        yield f"test.yml does not begin with Python {LEAST}"
    if LIBRARIES not in read(".github/workflows/test.yml"):
        yield f"test.yml lacks {LIBRARIES}"
    text = read(".github/workflows/wheels.yml")
    (python,) = re.findall(r'python-version: "3\.(\d+)"', text)
    if python not in BUILT or f"-cp3{python}-cp3{python}-" not in text:
        yield f"wheels.yml tries a wheel that is not built for Python 3.{python}"


def others() -> Iterator[str]:
    """Differences of all other files."""
    major, least = LEAST.split(".")
    if [str(minor) for minor in range(int(least), int(BUILT[-1]) + 1)] != BUILT:
        yield f"pyproject.toml: wheels are not built for each Python from {LEAST}"
    if FACTS["tool"]["ruff"]["target-version"] != f"py{major}{least}":
        yield "pyproject.toml: target-version of ruff"
    if f"find_package(Python {LEAST} " not in read("CMakeLists.txt"):
        yield "CMakeLists.txt: Python"
    if f"\nversion: {PROJECT['version']}\n" not in read("CITATION.cff"):
        yield "CITATION.cff: version"
    if f'"{PROJECT["version"]}"' not in read("src/cdem/_version.py"):
        yield "src/cdem/_version.py: version"
    missing = set(LIBRARIES.split()) - set(
        re.findall(r"missing\+=\((\w+)\)", read("tools/setup.sh"))
    )
    if missing:
        yield f"tools/setup.sh: lacks {', '.join(missing)}"
    page = read("docs/install.md")
    if f"Python {LEAST} or newer" not in page or f"`{LIBRARIES}`" not in page:
        yield "docs/install.md: Python or system packages"
    rows = re.findall(r"^\| (`\w+`(?:, `\w+`)*) \|", page, re.MULTILINE)
    if set(re.findall(r"\w+", " ".join(rows))) != set(PROJECT["optional-dependencies"]):
        yield "docs/install.md: the table of extras"


def main() -> None:
    """Print all differences; fail if there are any."""
    found = [f"packaging/conda/recipe.yaml: {one}" for one in recipe()]
    found += [f"Dockerfile: {one}" for one in dockerfile()]
    found += [f".github/workflows: {one}" for one in workflows()]
    sys.exit("\n".join([*found, *others()]) or 0)


if __name__ == "__main__":
    main()
