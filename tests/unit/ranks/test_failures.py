from cdem.errors import CaseError
from cdem.ranks.failures import words_of


def test_words_for_users_have_no_traceback():
    assert words_of(CaseError("a.yaml:1: wrong")) == "a.yaml:1: wrong"
    assert words_of(SystemExit(4)) == "ended with status 4"


def test_words_of_a_fault_tell_its_place():
    try:
        raise ValueError("of numbers")
    except ValueError as error:
        words = words_of(error)
    assert words.startswith("Traceback")
    assert "test_failures.py" in words
    assert words.endswith("ValueError: of numbers")
