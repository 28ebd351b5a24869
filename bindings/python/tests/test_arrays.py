# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Arrays of every layout have the bits of the array in C order, and what is none of them is refused in words."""

from __future__ import annotations

import sys
import threading

import numpy as np
import palpate as pp
import pytest

SHAPE = (pp.ball(0.5) & pp.cuboid([0.8, 0.8, 0.8])) - pp.cylinder(radius=0.2, height=2.0)
POINTS = np.random.default_rng(7).uniform(-1.0, 1.0, (1000, 3))
TRUTH = np.array([SHAPE.distance(list(point)) for point in POINTS])


def unaligned(points: np.ndarray) -> np.ndarray:
    """The same numbers, from an odd byte on."""
    raw = np.zeros(points.nbytes + 1, np.uint8)
    view = raw[1:].view(points.dtype).reshape(points.shape)
    view[:] = points
    return view


def read_only(points: np.ndarray) -> np.ndarray:
    points = points.copy()
    points.flags.writeable = False
    return points


LAYOUTS = {
    "C": POINTS,
    "Fortran": np.asfortranarray(POINTS),
    "transposed": np.ascontiguousarray(POINTS.T).T,
    "reversed": POINTS[::-1].copy()[::-1],
    "stepped": np.repeat(POINTS, 2, axis=0)[::2],
    "columns of a wider table": np.hstack([POINTS, POINTS])[:, :3],
    "unaligned": unaligned(POINTS),
    "read-only": read_only(POINTS),
    "swapped bytes": POINTS.astype(POINTS.dtype.newbyteorder()),
    "list": POINTS.tolist(),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_has_the_same_bits(layout: str) -> None:
    points = LAYOUTS[layout]
    assert np.array_equal(SHAPE.distance(points), TRUTH)
    distances, gradients = SHAPE.distance_gradient(points)
    assert np.array_equal(distances, TRUTH)
    assert np.array_equal(gradients, SHAPE.gradient(POINTS))


def test_axes_before_the_last_stay() -> None:
    assert SHAPE.distance(POINTS.reshape(10, 50, 2, 3)).shape == (10, 50, 2)
    assert SHAPE.gradient(POINTS.reshape(10, 100, 3)).shape == (10, 100, 3)
    assert SHAPE.distance(np.zeros((0, 3))).shape == (0,)
    assert SHAPE.distance(np.zeros((2, 0, 3))).shape == (2, 0)
    one, slope = SHAPE.distance_gradient(POINTS[0])
    assert one == TRUTH[0] and slope.shape == (3,)


def test_single_precision_stays_single() -> None:
    points = POINTS.astype(np.float32)
    distances, gradients = SHAPE.distance_gradient(points)
    assert distances.dtype == gradients.dtype == np.float32
    assert np.abs(distances - TRUTH).max() < 1e-6
    assert SHAPE.distance(np.array([0, 1, 0])) == SHAPE.distance([0, 1, 0])
    assert SHAPE.distance(POINTS.astype(np.float16)).dtype == np.float64


def test_out_is_filled() -> None:
    out = np.empty(1000)
    assert SHAPE.distance(POINTS, out=out) is out
    assert np.array_equal(out, TRUTH)
    slopes = np.empty((1000, 3))
    distances, gradients = SHAPE.distance_gradient(POINTS, out=(None, slopes))
    assert gradients is slopes and np.array_equal(distances, TRUTH)


@pytest.mark.parametrize(
    ("points", "error", "words"),
    [
        (np.zeros((5, 2)), ValueError, "points must have the shape (…, 3), got (5, 2)"),
        (np.zeros(4), ValueError, "points must have the shape (…, 3), got (4,)"),
        (3.0, ValueError, "points must have the shape (…, 3), got ()"),
        (POINTS + 1j, TypeError, "points must be real numbers, got an array of complex128"),
        (POINTS.astype(object), TypeError, "points must be real numbers, got an array of object"),
        (POINTS > 0, TypeError, "points must be real numbers, got an array of bool"),
        (np.ma.masked_array(POINTS), TypeError, "points must not be a masked array"),
        ("abc", TypeError, "points must be real numbers"),
        ([[0, 0, 0], [0, 0]], TypeError, "points must be an array of real numbers"),
        (None, TypeError, "points must be real numbers"),
    ],
)
def test_what_is_no_array_of_points_is_refused(points: object, error: type, words: str) -> None:
    with pytest.raises(error) as caught:
        SHAPE.distance(points)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("out", "error", "words"),
    [
        (np.empty(999), ValueError, "out must have the shape (1000,), got (999,)"),
        (np.empty(1000, np.float32), TypeError, "out must be an array of float64, got an array of float32"),
        (np.empty(2000)[::2], ValueError, "out must be in C order"),
        (read_only(np.empty(1000)), ValueError, "out must be writable, it is read-only"),
        ([0.0] * 1000, TypeError, "out must be an array of float64, got list"),
    ],
)
def test_what_cannot_be_filled_is_refused(out: object, error: type, words: str) -> None:
    with pytest.raises(error) as caught:
        SHAPE.distance(POINTS, out=out)
    assert words in str(caught.value)


def test_out_that_overlaps_the_points_is_refused() -> None:
    points = np.zeros((1000, 3))
    with pytest.raises(ValueError, match="share memory"):
        SHAPE.distance(points, out=points.reshape(-1)[:1000])
    with pytest.raises(ValueError, match="share memory"):
        SHAPE.gradient(points, out=points)


@pytest.mark.parametrize("threads", [0, 2, 3])
def test_threads_change_no_bit(threads: int) -> None:
    points = np.random.default_rng(3).uniform(-1.0, 1.0, (50_000, 3))
    assert np.array_equal(SHAPE.distance(points, threads=threads), SHAPE.distance(points))
    assert np.array_equal(SHAPE.gradient(points, threads=threads), SHAPE.gradient(points))


def test_threads_beyond_reason_are_refused() -> None:
    for threads in (-1, 1025):
        with pytest.raises(ValueError, match=f"threads must be 0, .* or from 1 to 1024, got {threads}"):
            SHAPE.distance(POINTS, threads=threads)


def test_numbers_that_are_none_are_passed_on() -> None:
    assert np.isnan(pp.ball(0.5).distance([np.nan, 0, 0]))
    assert pp.ball(0.5).distance([np.inf, 0, 0]) == np.inf


def test_no_references_leak() -> None:
    out, points = np.empty(1000), POINTS.copy()
    SHAPE.distance(points, out=out)
    before = sys.getrefcount(points), sys.getrefcount(out), sys.getrefcount(SHAPE)
    for _ in range(1000):
        SHAPE.distance(points, out=out)
        SHAPE.distance_gradient(points, out=(out, None))
        with pytest.raises(ValueError):
            SHAPE.distance(points, out=out[:3])
    assert (sys.getrefcount(points), sys.getrefcount(out), sys.getrefcount(SHAPE)) == before


def test_many_threads_of_python_share_a_shape() -> None:
    found: list[bool] = []

    def ask() -> None:
        for _ in range(20):
            found.append(np.array_equal(SHAPE.distance(POINTS), TRUTH))

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 160 and all(found)


def test_booleans_are_no_coordinates() -> None:
    # Those of a list were read as numbers, those of an array refused.
    for points in ([True, False, False], np.array([True, False, False])):
        with pytest.raises(TypeError, match="real numbers"):
            pp.ball(0.5).distance(points)


def test_what_an_array_raises_itself_is_raised() -> None:
    # An array that computes itself was stopped by Ctrl-C, and a TypeError told.
    class Stopped:
        def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        pp.ball(0.5).distance(Stopped())


def test_one_point_takes_no_threads_that_are_none() -> None:
    with pytest.raises(ValueError, match="threads must be 0"):
        pp.ball(0.5).distance([0, 0, 0], threads=-5)
    with pytest.raises(ValueError, match="^out must have the shape"):
        pp.ball(0.5).gradient(np.zeros((4, 3)), out=np.zeros((3, 3)))
