"""Build the compiled core incrementally and put it in place, without pip.

Without options it builds a module for every instruction set, or for that of this CPU and those that
the environment variable CDEM_ISAS lists.
"""

import argparse
import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

ROOT = Path(__file__).parent.parent
PLACE = Path(sysconfig.get_path("platlib")) / "cdem"


def native() -> str:
    """The best instruction set of this CPU, as the package chooses it."""
    if platform.machine() not in ("x86_64", "AMD64"):
        return "generic"
    path = ROOT / "src" / "cdem" / "_instruction_sets.py"
    spec = importlib.util.spec_from_file_location("instruction_sets", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.native()


def sets() -> list[str]:
    """The instruction sets to build a module for."""
    return list(dict.fromkeys([native(), *os.environ.get("CDEM_ISAS", "x86_64 v3 v4").split()]))


def run(command: list[str], quiet: bool = False) -> str:
    """Run a command with the tools of this Python; end with its status if it fails.

    Returns:
        What a quiet command has printed; it is shown if the command fails.
    """
    tools = Path(sys.executable).parent
    env = os.environ | {"PATH": f"{tools}:{os.environ['PATH']}"}
    pipe = subprocess.PIPE if quiet else None
    done = subprocess.run(
        command, env=env, check=False, text=True, stdout=pipe, stderr=pipe and subprocess.STDOUT
    )
    if done.returncode:
        print(done.stdout or "", file=sys.stderr)
        sys.exit(done.returncode)
    return done.stdout or ""


def configure(folder: Path, settings: dict[str, str]) -> None:
    """Configure a build folder where a setting is new."""
    cache = folder / "CMakeCache.txt"
    known = cache.read_text().splitlines() if (folder / "build.ninja").exists() else []
    wanted = [f"{name}:STRING={value}" for name, value in settings.items()]
    if not known or not set(wanted) <= set(known):
        command = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja"]
        command += [f"-DPython_EXECUTABLE={sys.executable}", *(f"-D{one}" for one in wanted)]
        run(command)


def place(folder: Path, module: str, beside: bool = False) -> None:
    """Copy modules that are not those in place; the others leave, but for those `beside` it."""
    PLACE.mkdir(parents=True, exist_ok=True)
    built = {p.name: p for p in folder.glob(f"{module}.*.so") if "own_laws" not in p.name}
    for old in PLACE.glob("_core_*.so"):
        if old.name not in built and not beside:
            old.unlink()
    for name, new in built.items():
        old = PLACE / name
        if not old.exists() or old.stat().st_mtime != new.stat().st_mtime:
            fresh = old.with_suffix(".new")  # a process may have the old one loaded
            shutil.copy2(new, fresh)
            fresh.replace(old)


def options() -> argparse.Namespace:
    """The options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--native", action="store_true", help="only the module for this CPU")
    parser.add_argument("--tests", action="store_true", help="core_tests as well")
    parser.add_argument("--own-laws", action="store_true", help="the core with laws of tests/core")
    parser.add_argument(
        "--coverage",
        dest="special",
        action="store_const",
        const="coverage",
        help="module and tests that count executed lines",
    )
    parser.add_argument(
        "--emulated",
        dest="special",
        action="store_const",
        const="emulated",
        help="module and tests for the emulated device",
    )
    parser.add_argument(
        "--sanitize",
        dest="special",
        choices=["address", "thread"],
        help="module and tests, by clang, that end at a wrong access or at a race of threads",
    )
    return parser.parse_args()


def main() -> None:
    """Build what the options ask for."""
    wants = options()
    special = wants.special
    one, tests = wants.native or special, wants.tests or special
    core = "emulated" if special == "emulated" else native()
    module = f"_core_{core}" if one else "_core_*"
    targets = [module if one else "all"]
    targets += ["core_tests"] * bool(tests) + ["_core_own_laws"] * wants.own_laws
    settings = {} if special else {"CDEM_ISAS": ";".join(sets())}
    if tests or wants.own_laws:
        settings["CDEM_TESTS"] = core
    if special == "emulated":
        settings["CDEM_EMULATED"] = "ON"
    elif special:
        settings["CMAKE_BUILD_TYPE"] = special.capitalize()
    sanitized = special in ("address", "thread")
    if sanitized:
        settings["CMAKE_CXX_COMPILER"] = "clang++"
    folder = ROOT / "build" / (special or "core")
    configure(folder, settings)
    run(["ninja", "-C", str(folder), *targets])
    if not sanitized:  # Python loads such a module only with the library of the sanitizer
        place(folder, module, beside=special == "emulated")


if __name__ == "__main__":
    main()
