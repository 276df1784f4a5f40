"""Joints of made-up outcrops, against the planes and lengths from which they were made."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from shared.outcrops import blocky, ledges, thinned_out

from cdem.outcrop.extraction import extract
from cdem.outcrop.survey import OutcropSurvey
from cdem.outcrop.traces import ends_seen, mean_length

FULL = 1.5
"""Area of the planes that must be found, as a multiple of the smallest area of a facet."""


def surveyed(outcrop, tmp_path, **more):
    """Facets and sets of an outcrop."""
    return OutcropSurvey.of(tmp_path / "cloud.laz", extract(outcrop.points, **more), count=3)


def compare(outcrop, found):
    """Of each set: angle of the mean plane [deg], ratios of spacing and area, to the cloud's own.

    The truth is the sample in the cloud: the planes of which it shows enough for a facet, their mean
    normal, the mean of the gaps between them, and their area by the density of points.
    """
    near = cKDTree(outcrop.points)
    x, facets = found.found.points, found.found.facets
    own = [outcrop.plane[near.query(x[m])[1]] for m in facets.members]
    plane = np.array([np.bincount(p[p >= 0]).argmax() for p in own])
    count = np.bincount(outcrop.plane[outcrop.plane >= 0], minlength=len(outcrop.set_of))
    area = count / outcrop.density
    for k, exposure in enumerate(found.exposures):
        mine = found.set_of == k
        names, times = np.unique(outcrop.set_of[plane[mine]], return_counts=True)
        assert times.max() > 0.95 * times.sum()  # facets of one true set
        true = (outcrop.set_of == names[times.argmax()]) & (area > FULL * found.found.smallest)
        mean = outcrop.normals[np.unique(plane[mine])].mean(axis=0)
        off = found.survey.fit.sets[k].normal @ (mean / np.linalg.norm(mean))
        gap = np.diff(np.sort(outcrop.offsets[true])).mean()
        yield (
            float(np.degrees(np.arccos(min(1.0, abs(off))))),
            exposure.spacing.persistent / gap,
            exposure.area / area[true].sum(),
        )


def test_sets_spacing_and_areas(tmp_path):
    """Three sets of parallel planes, 33,000 points with a noise of 5 mm."""
    outcrop = blocky(size=4.0, density=900, seed=5)
    assert 15_000 < len(outcrop.points) < 40_000
    found = surveyed(outcrop, tmp_path)
    for angle, spacing, area in compare(outcrop, found):
        assert angle < 1 and spacing == pytest.approx(1, abs=0.05)
        assert area == pytest.approx(1, abs=0.05)
    assert found.found.noise == pytest.approx(0.0044, rel=0.15)  # voxels average 1.3 points


def test_a_turned_cloud_has_the_same_facets():
    """Facets by their planes: where two parts of a plane touch at a corner they may count as one."""
    outcrop = blocky(size=3.0, density=900, seed=5)
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    one, two = extract(outcrop.points), extract(outcrop.points @ turn.T)
    assert two.resolution == pytest.approx(one.resolution)
    large = np.flatnonzero(one.facets.areas > 0.3)
    assert len(large) > 10
    for k in large:
        center, normal = one.facets.centers[k], one.facets.normals[k]
        areas = []
        for facets, back in ((one.facets, np.eye(3)), (two.facets, turn)):
            off = np.abs((facets.centers @ back - center) @ normal)
            same = (off < 0.03) & (np.abs(facets.normals @ back @ normal) > np.cos(np.radians(6)))
            areas.append(facets.areas[same].sum())
        assert areas[1] == pytest.approx(areas[0], rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.003, 0.01])
def test_scattered_planes_holes_and_an_uneven_density(tmp_path, noise):
    """Planes scattered with kappa 1500 (1.5 deg), 12 holes, density down to 40 %, doubled points, and
    a hundredth of the points in the air."""
    whole = blocky(size=10, density=2_000, kappa=1500, seed=3, noise=noise)
    outcrop = thinned_out(whole)
    found = surveyed(outcrop, tmp_path, smallest=0.05)
    for angle, spacing, _ in compare(outcrop, found):
        assert angle < 1 and spacing == pytest.approx(1, abs=0.05)
    for _, _, area in compare(whole, found):
        assert 0.85 < area < 1.02  # holes and thin parts are missing


@pytest.mark.slow
def test_mean_length_of_traces_cut_by_the_window():
    """More than 400 ledges of exponential lengths, a quarter of whose ends lie beyond the cloud.

    The truth is the cloud's own sample: twice the length inside over the ends inside, of the ledges
    that are long enough for a facet. It is near the mean of the law of lengths above this smallest
    length t, mean + t. The mean of the lengths as they are seen is too short.
    """
    lengths, seen, inside = [], [], []
    for seed in (2, 3):
        x, _, own = ledges(width=9.0, rows=110, mean=2.5, density=900, seed=seed)
        found = extract(x)
        facets = found.facets
        dips = np.degrees(np.arccos(facets.normals[:, 2]))
        level = (np.abs(dips - 30) < 2) & (facets.normals[:, 1] < 0)
        both = np.flatnonzero(level & (facets.lengths[:, 1] < 0.35))  # upper and lower sides
        lengths.append(facets.lengths[both, 0])
        seen.append(ends_seen(found.points, facets, found.resolution)[both])
        inside.append(own)
    length, own = np.concatenate(lengths), np.concatenate(inside)
    found = mean_length(length, np.concatenate(seen))
    shortest = float(np.percentile(length, 1))
    own = own[own[:, 0] > shortest]
    true = mean_length(own[:, 0], own[:, 1:] > 0)
    assert found.traces > 800 and abs(found.traces / (2 * true.traces) - 1) < 0.08
    assert found.mean == pytest.approx(true.mean, rel=0.1)
    assert found.mean == pytest.approx(2.5 + shortest, rel=0.1)
    assert found.naive < 0.85 * true.mean
