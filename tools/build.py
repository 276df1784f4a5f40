"""Build the compiled core incrementally and put it in place, without pip.

`python tools/build.py` builds a module for every instruction set, `--native` only the one of this
CPU: then those of the others leave, for they would be old.
"""

import importlib.util
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

ROOT = Path(__file__).parent.parent
BUILD = ROOT / "build" / "core"
PLACE = Path(sysconfig.get_path("platlib")) / "cdem"


def native() -> str:
    """The best instruction set of this CPU, as the package chooses it."""
    path = ROOT / "src" / "cdem" / "_instruction_sets.py"
    spec = importlib.util.spec_from_file_location("instruction_sets", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.native()


def main() -> None:
    """Configure once, build, copy what has changed."""
    tools = Path(sys.executable).parent
    env = os.environ | {"PATH": f"{tools}:{os.environ['PATH']}"}
    if not (BUILD / "build.ninja").exists():
        configure = ["cmake", "-S", str(ROOT), "-B", str(BUILD), "-G", "Ninja"]
        subprocess.run([*configure, f"-DPython_EXECUTABLE={sys.executable}"], env=env, check=True)
    wanted = [f"_core_{native()}"] if "--native" in sys.argv else ["all"]
    subprocess.run(["ninja", "-C", str(BUILD), *wanted], env=env, check=True)
    PLACE.mkdir(parents=True, exist_ok=True)
    for old in PLACE.glob("_core_*.so"):
        if wanted != ["all"] and not old.name.startswith(wanted[0]):
            old.unlink()
    pattern = "_core_*.so" if wanted == ["all"] else f"{wanted[0]}*.so"
    for new in BUILD.glob(pattern):
        old = PLACE / new.name
        if not old.exists() or old.stat().st_mtime < new.stat().st_mtime:
            shutil.copy2(new, old)


if __name__ == "__main__":
    main()
