"""What the audit refuses: a model that could not move."""

import pytest
from shared.cases import FALL

import cdem


def test_a_time_step_of_nothing_is_refused(tmp_path):
    """It would be divided by."""
    path = tmp_path / "case.yaml"
    path.write_text(FALL.replace('"5 ms"', '"5 ms", damping: {contact: 1.0e+30, stiffness: 0.5}'))
    with pytest.raises(cdem.CaseError, match="the stable time step is 0 s, for group cube"):
        cdem.Simulation(path)
