"""Which compiled core is chosen."""

import importlib
import os

import pytest

from cdem import _core_choice, _native
from cdem.errors import BackendError


@pytest.mark.parametrize("device", _core_choice.DEVICES)
def test_a_device_is_chosen_where_it_is_named_and_built(monkeypatch, device):
    monkeypatch.setattr(_core_choice, "_is_built", lambda name: True)
    monkeypatch.delenv("CDEM_ISA", raising=False)
    assert _core_choice.choose() not in _core_choice.DEVICES
    assert device not in _core_choice.built()
    monkeypatch.setenv("CDEM_ISA", device)
    assert _core_choice.choose() == device


@pytest.mark.parametrize("device", _core_choice.DEVICES)
def test_a_device_without_a_core_is_told_of(monkeypatch, device):
    monkeypatch.setattr(_core_choice, "_is_built", lambda name: name not in _core_choice.DEVICES)
    monkeypatch.setenv("CDEM_ISA", device)
    with pytest.raises(BackendError, match=f"no such compiled core; make it: make {device}"):
        _core_choice.choose()


@pytest.mark.parametrize("policy", ["passive", None])
def test_threads_wait_as_the_user_asks(monkeypatch, policy):
    monkeypatch.setenv("GOMP_SPINCOUNT", "")  # so that it is put back
    monkeypatch.delenv("GOMP_SPINCOUNT")
    monkeypatch.delenv("OMP_WAIT_POLICY", raising=False)
    if policy:
        monkeypatch.setenv("OMP_WAIT_POLICY", policy)
    importlib.reload(_native)
    assert ("GOMP_SPINCOUNT" in os.environ) == (policy is None)
