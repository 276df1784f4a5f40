"""Make the sdist, from it the wheel, install that where no clone is, and do what a user does first.

`python tools/try_package.py` builds; `python tools/try_package.py WHEEL` tries a wheel that is there.
Prints how long it takes from `pip install` to the first result and to the first picture, and what the
light install takes on disk, package by package. Where qemu-x86_64 is, an emulated CPU without AVX
must compute the same bytes as this one. Ends at the first command that fails.
"""

import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD_SDIST = (
    "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
)
SIZES = """
import os
from importlib.metadata import distributions
rows = []
for package in distributions():
    paths = [str(file.locate()) for file in package.files or []]
    sizes = [(p, os.path.getsize(p)) for p in paths if "__pycache__" not in p and os.path.exists(p)]
    rows.append((sum(n for _, n in sizes), sum(-(-n // 4096) * 4096 for _, n in sizes),
                 package.name, package.version))
rows = [row for row in rows if row[2] not in ("pip", "setuptools")]
print(f"{'package':<20} {'version':<10} {'MB':>6} {'MB in blocks of 4 kB':>20}")
for size, blocks, name, version in sorted(rows, reverse=True):
    print(f"{name:<20} {version:<10} {size / 1e6:>6.1f} {blocks / 1e6:>20.1f}")
print(f"{'all':<31} {sum(r[0] for r in rows) / 1e6:>6.1f} {sum(r[1] for r in rows) / 1e6:>20.1f}")
"""
NOTICES = {
    "LICENSE": ["Apache License"],
    "NOTICES.txt": ["nanobind (BSD-3-Clause)", "robin-map (MIT)", "libgomp (GPL-3.0-or-later"],
}
"""What must be in a package, and how lines of it begin."""
RESULT = [
    "cdem doctor",
    "cdem new incline",
    "cdem check incline.yaml",
    "cdem run incline.yaml --threads 1 --quiet",
]
"""To the first result."""
OLD_CPU = (
    "CDEM_ISA=x86_64 qemu-x86_64 -cpu Nehalem bare/bin/python -m cdem run incline.yaml"
    " -o old.results --threads 1 --quiet && cmp incline.results/histories.csv old.results/histories.csv"
)
"""A CPU of 2008; NumPy needs one as new."""
MORE = [
    "cdem new landslide",
    "cdem run landslide.yaml --threads 1 --quiet",
    "cdem info landslide.results",
    "cdem verify bar_waves bonded_bar sliding --threads 1",
]
LAWS = [
    "cdem law new my-clay --kind block",
    "cdem law build my_clay.hpp",
    'cdem law test my_clay.hpp --allow-code --path "triaxial 5 MPa" --set yield_stress="20 MPa"',
]


def run(command: list[str] | str, **more: object) -> float:
    """Run a command, or end with its status.

    Returns:
        The time it took [s].
    """
    shown = command if isinstance(command, str) else " ".join(command).split("\n")[0]
    print(f"$ {shown}", flush=True)
    began = time.perf_counter()
    status = subprocess.run(command, check=False, **more).returncode
    if status:
        sys.exit(f"{shown}: status {status}")
    seconds = time.perf_counter() - began
    print(f"  {seconds:.0f} s", flush=True)
    return seconds


def run_all(commands: list[str], work: dict[str, object]) -> float:
    """Run commands of a shell; the time they took [s]."""
    return sum(run(command, shell=True, **work) for command in commands)


def make_wheel(folder: Path) -> Path:
    """The wheel that the sdist gives."""
    run([sys.executable, "-c", BUILD_SDIST, str(folder)], cwd=ROOT)
    tools = Path(sys.executable).parent
    env = os.environ | {"PATH": f"{tools}:{os.environ['PATH']}"}
    pip = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation"]
    run([*pip, "-w", str(folder), str(next(folder.glob("*.tar.gz")))], env=env)
    return next(folder.glob("*.whl"))


def check_notices(package: Path) -> None:
    """Stop if a wheel or sdist lacks the licences of what it brings along."""
    texts: dict[str, bytes] = {}
    if package.suffix == ".whl":
        with zipfile.ZipFile(package) as wheel:
            texts = {
                Path(n).name: wheel.read(n) for n in wheel.namelist() if Path(n).name in NOTICES
            }
    else:
        with tarfile.open(package) as sdist:
            for member in sdist:
                if Path(member.name).name in NOTICES and (file := sdist.extractfile(member)):
                    texts[Path(member.name).name] = file.read()
    for needed, titles in NOTICES.items():
        lines = texts.get(needed, b"").decode().splitlines()
        for title in titles:
            if not any(line.strip().startswith(title) for line in lines):
                sys.exit(f"{package.name}: its {needed} has nothing of {title}")


def main() -> None:
    """Build, install, print sizes, run."""
    with tempfile.TemporaryDirectory(prefix="a place ") as place:
        folder = Path(place)
        wheel = Path(sys.argv[1]).resolve() if sys.argv[1:] else make_wheel(folder)
        for package in (wheel, *folder.glob("*.tar.gz")):
            check_notices(package)
        print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB")
        run([sys.executable, "-m", "venv", str(folder / "bare")])
        tools = folder / "bare" / "bin"
        env = {name: text for name, text in os.environ.items() if not name.startswith("PYTHON")}
        env["PATH"] = f"{tools}:/usr/local/bin:/usr/bin:/bin"
        work = {"cwd": folder, "env": env}
        try_wheel(wheel, str(tools / "python"), work)


def try_wheel(wheel: Path, python: str, work: dict[str, object]) -> None:
    """Install a wheel, and do what a user does first."""
    install = f'"{python}" -m pip install -q "{wheel}'
    seconds = run_all([f'{install}"', *RESULT], work)
    print(f"from pip install to the first result: {seconds:.0f} s")
    run([python, "-c", SIZES], **work)
    seconds += run_all([f'{install}[viz]"', "cdem plot incline.results"], work)
    print(f"from pip install to the first picture: {seconds:.0f} s")
    if shutil.which("qemu-x86_64"):
        run(OLD_CPU, shell=True, **work)
    else:
        print("a CPU without AVX: not tried, no qemu-x86_64 (Debian package qemu-user)")
    run_all([*MORE, f'{install}[laws]"', *LAWS], work)


if __name__ == "__main__":
    main()
