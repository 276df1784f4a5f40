"""A whole file beside the case: problems have their places, and its schema its name."""

from collections.abc import Iterator

import pytest

from cdem.case.document import Document
from cdem.case.source import Keys
from cdem.errors import CaseError


class Pairs(Document):
    """Two numbers, the first of which is the smaller."""

    low: float
    high: float

    def _contradictions(self) -> Iterator[tuple[Keys, str]]:
        if self.low >= self.high:
            yield ("low",), "is not below high"


def test_values_of_the_wrong_kind_and_unknown_keys():
    with pytest.raises(CaseError) as caught:
        Pairs(low="a", height=3)
    text = str(caught.value)
    assert "low" in text and "height" in text and "high" in text and "Traceback" not in text


def test_problems_between_keys_come_when_each_is_right():
    assert Pairs(low=1, high=2).high == 2
    with pytest.raises(CaseError, match="low: is not below high"):
        Pairs(low=2, high=1)


def test_schema():
    schema = Pairs.schema()
    assert schema["title"] == "cdem pairs"
    assert set(schema["properties"]) == {"low", "high"}
