"""Build what a file needs and run the tests that mirror it: `make check F=core/base/math.hpp`.

- core/a/b.hpp or .cpp: tests/core/a/test_b.cpp, else the tests of its folder, else all of
  tests/core; then the pinned results on one thread.
- src/cdem/a/b.py: tests/unit/a/test_b.py, else the tests of its package.
- a test: itself.
"""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent


def run(*command: str) -> None:
    """Run a command from the root; end with its status if it fails."""
    print("+", " ".join(command), flush=True)
    status = subprocess.run(command, cwd=ROOT, check=False).returncode
    if status:
        sys.exit(status)


def pytest(*words: str) -> None:
    """Run some of the tests in Python."""
    run(sys.executable, "-m", "pytest", *words)


def mirror(path: Path, source: str, tests: str, suffix: str) -> Path:
    """Tests of a file below `source`, else the nearest folder that has some."""
    if path.is_relative_to(tests):
        return path if path.name.startswith("test_") else path.parent
    inside = path.relative_to(source)
    own = tests / inside.parent / f"test_{inside.stem}{suffix}"
    return next(place for place in (own, *own.parents) if (ROOT / place).exists())


def check_core(path: Path) -> None:
    """Tests of the core, then the results that the module gives."""
    tests = mirror(path, "core", "tests/core", ".cpp")
    run(sys.executable, "tools/build.py", "--native", "--tests")
    every = "*" if (ROOT / tests).is_dir() else ""
    run("build/core/core_tests", f"--source-file=*/{tests}{every}", "--no-skipped-summary")
    pytest("-x", "tests/regression/test_golden.py", "-k", "pinned and not 3")


def main() -> None:
    """Find out which language the file is in."""
    if len(sys.argv) != 2 or not (ROOT / sys.argv[1]).is_file():
        sys.exit("usage: make check F=path, a file of core/, src/cdem/ or tests/")
    path = Path(sys.argv[1])
    if path.is_relative_to("core") or path.is_relative_to("tests/core"):
        check_core(path)
    elif path.is_relative_to("src/cdem"):
        pytest(str(mirror(path, "src/cdem", "tests/unit", ".py")))
    elif path.is_relative_to("tests"):
        pytest(str(path))
    else:
        sys.exit(f"{path}: no tests mirror it")


if __name__ == "__main__":
    main()
