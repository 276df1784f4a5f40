"""Build the compiled core incrementally and put it in place, without pip.

Without options it builds a module for every instruction set.
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


def run(command: list[str]) -> None:
    """Run a command with the tools of this Python; end with its status if it fails."""
    tools = Path(sys.executable).parent
    env = os.environ | {"PATH": f"{tools}:{os.environ['PATH']}"}
    status = subprocess.run(command, env=env, check=False).returncode
    if status:
        sys.exit(status)


def build(folder: Path, settings: dict[str, str], targets: list[str]) -> None:
    """Configure where a setting is new, and build."""
    cache = folder / "CMakeCache.txt"
    known = cache.read_text().splitlines() if (folder / "build.ninja").exists() else []
    wanted = [f"{name}:STRING={value}" for name, value in settings.items()]
    if not known or not set(wanted) <= set(known):
        configure = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja"]
        configure += [f"-DPython_EXECUTABLE={sys.executable}", *(f"-D{one}" for one in wanted)]
        run(configure)
    run(["ninja", "-C", str(folder), *targets])


def place(folder: Path, module: str) -> None:
    """Copy modules that are not those in place; old ones of other instruction sets leave."""
    PLACE.mkdir(parents=True, exist_ok=True)
    built = {p.name: p for p in folder.glob(f"{module}.*.so") if "own_laws" not in p.name}
    for old in PLACE.glob("_core_*.so"):
        if old.name not in built:
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
        "--sanitize",
        dest="special",
        choices=["address", "thread"],
        help="module and tests, by clang, that end at a wrong access or at a race of threads",
    )
    return parser.parse_args()


def main() -> None:
    """Build what the options ask for."""
    wants = options()
    one, tests = wants.native or wants.special, wants.tests or wants.special
    sanitized = wants.special in ("address", "thread")
    module = f"_core_{native()}" if one else "_core_*"
    targets = [module if one else "all"]
    targets += ["core_tests"] * bool(tests) + ["_core_own_laws"] * wants.own_laws
    settings = {"CDEM_TESTS": native()} if tests or wants.own_laws else {}
    if wants.special:
        settings["CMAKE_BUILD_TYPE"] = wants.special.capitalize()
    if sanitized:
        settings["CMAKE_CXX_COMPILER"] = "clang++"
    folder = ROOT / "build" / (wants.special or "core")
    build(folder, settings, targets)
    if not sanitized:  # Python loads such a module only with the library of the sanitizer
        place(folder, module)


if __name__ == "__main__":
    main()
