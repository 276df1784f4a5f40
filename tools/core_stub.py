"""Write the signatures of the compiled core for type checkers, src/cdem/_core.pyi.

`python tools/core_stub.py` writes them from the core that is built; `--check` only says whether they
are those of that core.
"""

import sys
from pathlib import Path

from nanobind.stubgen import StubGen

from cdem import _native

STUB = Path(__file__).resolve().parent.parent / "src/cdem/_core.pyi"
HEAD = '"""Signatures of the compiled core, by `python tools/core_stub.py`."""\n\n'


def text() -> str:
    """The stub of the core that is built."""
    stub = StubGen(_native.core, max_expr_length=0)  # values differ from set to set
    stub.put(_native.core)
    return HEAD + stub.get().rstrip() + "\n"


def main() -> None:
    """Write the stub, or fail where it is another."""
    if sys.argv[1:] != ["--check"]:
        STUB.write_text(text())
    elif STUB.read_text() != text():
        sys.exit(f"{STUB.name} is not that of the built core: python tools/core_stub.py")


if __name__ == "__main__":
    main()
