"""What docs/versions.md calls public is in the reference of Python."""

from pathlib import Path

import cdem

REFERENCE = Path(__file__).resolve().parents[3] / "docs/reference/python.rst"


def test_every_public_name_is_in_the_reference():
    text = REFERENCE.read_text()
    missing = [n for n in [*cdem.__all__, "open"] if n != "__version__" and f"cdem.{n}" not in text]
    assert missing == []
