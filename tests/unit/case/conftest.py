"""A case file in a folder of its own, and what is said about it when it is wrong."""

import pytest
from shared.cases import INCLINE

from cdem import Case, CaseError


@pytest.fixture
def write(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(text: str) -> str:
        (tmp_path / "slope.yaml").write_text(text)
        return "slope.yaml"

    return write


@pytest.fixture
def complaint(write):
    """What is said about the incline with one text in place of another."""

    def complaint(old: str, new: str) -> str:
        assert old in INCLINE
        with pytest.raises(CaseError) as caught:
            Case.load(write(INCLINE.replace(old, new, 1)))
        return str(caught.value)

    return complaint
