"""Response of layered ground to plane waves that go straight up: Thomson (1950), Haskell (1953)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.seismic.processing import transform_length

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]
TAPERED = 0.1
"""Part of a band below its highest frequency over which a deconvolution fades [1]."""


@dataclass(frozen=True)
class Layer:
    """A layer, or the half space below the last one.

    Attributes:
        thickness: [m]; of no meaning for the half space.
        density: [kg/m3].
        speed: Wave speed, of S or P waves [m/s].
        damping: Fraction of critical, at all frequencies [1].
    """

    thickness: float
    density: float
    speed: float
    damping: float


def waves(layers: Sequence[Layer], frequency: Floats) -> tuple[Complex, Complex]:
    """Up-going and down-going wave at the top of the half space, for an up-going wave of 1 at the surface.

    Args:
        layers: From the surface down; the last is the half space.
        frequency: [Hz].
    """
    w = 2 * np.pi * np.asarray(frequency, float)
    up, down = np.ones(len(w), complex), np.ones(len(w), complex)
    speeds = [layer.speed * np.sqrt(1 + 2j * layer.damping) for layer in layers]
    for upper, lower in zip(range(len(layers) - 1), range(1, len(layers)), strict=True):
        ratio = layers[upper].density * speeds[upper] / (layers[lower].density * speeds[lower])
        shift = np.exp(1j * w / speeds[upper] * layers[upper].thickness)
        rising, falling = up * shift, down / shift
        up = 0.5 * (rising * (1 + ratio) + falling * (1 - ratio))
        down = 0.5 * (rising * (1 - ratio) + falling * (1 + ratio))
    return up, down


def surface_over_up(layers: Sequence[Layer], frequency: Floats) -> Complex:
    """Motion of the surface over the up-going wave in the half space."""
    return 2 / waves(layers, frequency)[0]


def surface_over_outcrop(layers: Sequence[Layer], frequency: Floats) -> Complex:
    """Motion of the surface over that of the half space where it crops out."""
    return 1 / waves(layers, frequency)[0]


def surface_over_within(layers: Sequence[Layer], frequency: Floats) -> Complex:
    """Motion of the surface over that at the top of the half space below the layers."""
    up, down = waves(layers, frequency)
    return 2 / (up + down)


def at_surface(layers: Sequence[Layer], upgoing: Floats, step: float) -> Floats:
    """Motion of the surface for an up-going wave, in the same quantity and at the same times."""
    return _times(upgoing, step, lambda f: surface_over_up(layers, f))


def deconvolved(
    layers: Sequence[Layer], surface: Floats, step: float, highest: float
) -> tuple[Floats, float]:
    """Up-going wave in the half space that gives a motion of the surface.

    High frequencies grow on the way down, so they fade from 0.9 of the highest frequency on.

    Args:
        layers: From the surface down.
        surface: Motion of the surface, any quantity.
        step: Time between samples [s].
        highest: No wave above this frequency [Hz].

    Returns:
        The up-going wave, shape as `surface`, and the largest factor by which a frequency grew.
    """
    largest = 0.0

    def inverse(f: Floats) -> Complex:
        nonlocal largest
        fade = 0.5 * (1 - np.cos(np.pi * ((highest - f) / (TAPERED * highest)).clip(0, 1)))
        out = np.zeros(len(f), complex)
        kept = fade > 0
        out[kept] = fade[kept] / surface_over_up(layers, f[kept])
        largest = float(np.abs(out).max())
        return out

    return _times(surface, step, inverse), largest


def _times(values: Floats, step: float, factor: Callable[[Floats], Complex]) -> Floats:
    """A signal with its spectrum multiplied by a factor of the frequency."""
    size = transform_length(len(values))
    frequency = np.fft.rfftfreq(size, step).astype(np.float64)
    spectrum: Complex = np.fft.rfft(values, size) * factor(frequency)
    return np.fft.irfft(spectrum, size)[: len(values)]
