# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Fields that are functions of Python."""

from __future__ import annotations

import pickle
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import palpate as pp
import pytest


def norm(points: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points, axis=1) - 0.5


BALL = pp.from_function(norm, lipschitz=1.0, bounds=[[-0.5] * 3, [0.5] * 3])
POINTS = np.random.default_rng(4).uniform(-1, 1, (500, 3))


def test_a_function_is_a_shape() -> None:
    truth = pp.ball(0.5)
    assert np.abs(BALL.distance(POINTS) - truth.distance(POINTS)).max() < 1e-15
    assert np.abs(BALL.gradient(POINTS) - truth.gradient(POINTS)).max() < 1e-6
    assert BALL.distance([0, 1, 0]) == 0.5 and "lipschitz" in BALL.promise.outside
    both = BALL | pp.cuboid([1, 1, 1]).translated([1, 0, 0])
    found = pp.separation(both, pp.ball(0.1).translated([0, 1, 0]), tolerance=1e-3)
    assert found.lower <= 0.4 <= found.upper
    assert np.array_equal(BALL.distance(POINTS, threads=2), BALL.distance(POINTS))
    flat = pp.from_function(norm, lipschitz=1.0, dimension=2)
    assert flat.distance([0.0, 1.0]) == 0.5


def test_a_function_is_opaque() -> None:
    assert repr(BALL) == "<function norm>" and BALL == BALL and BALL != pp.from_function(norm, lipschitz=1.0)
    for refused in [lambda: pickle.dumps(BALL), lambda: BALL.to_json(), lambda: pp.Scene(BALL)]:
        with pytest.raises(pp.Error):
            refused()


def test_what_a_function_raises_is_raised() -> None:
    def broken(_points: np.ndarray) -> np.ndarray:
        raise ZeroDivisionError("in the function")

    shape = pp.from_function(broken, lipschitz=1.0, bounds=[[-1] * 3, [1] * 3])
    for ask in [
        lambda: shape.distance([0, 0, 0]),
        lambda: shape.distance(POINTS),
        lambda: shape.gradient(POINTS, threads=2),
        lambda: shape.at([0, 0, 0]),
        lambda: pp.separation(shape, pp.ball(0.1)),
        lambda: pp.separations(shape, pp.ball(0.1), [[0, 0, 0]]),
        lambda: shape.mesh(cell=0.2),
        lambda: shape.figure(),
        lambda: shape.render(width=16, height=16),
        lambda: shape.mass(),
    ]:
        with pytest.raises(ZeroDivisionError, match="in the function"):
            ask()
    assert pp.ball(0.5).distance([0, 1, 0]) == 0.5


def test_a_function_that_asks_itself_is_stopped() -> None:
    own: list[pp.Shape] = []
    own.append(pp.from_function(lambda points: own[0].distance(points), lipschitz=1.0))
    with pytest.raises(RecursionError):
        own[0].distance(np.zeros((2, 3)))
    with pytest.raises(RecursionError):
        own[0].distance([0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: pp.from_function(3, lipschitz=1.0), TypeError, "must be callable"),
        (lambda: pp.from_function(norm, lipschitz=0), ValueError, "lipschitz must be positive"),
        (lambda: pp.from_function(norm, lipschitz=1.0, dimension=4), ValueError, "dimension must be 2 or 3"),
        (lambda: pp.from_function(norm, lipschitz=1.0, bounds=[0, 1]), ValueError, "bounds must have the shape (2, 3), got (2,)"),
        (lambda: pp.from_function(norm, lipschitz=1.0, bounds=[[1] * 3, [0] * 3]), ValueError, "the lower corner"),
        (lambda: pp.from_function(lambda p: p, lipschitz=1.0).distance(POINTS), ValueError, "an array of shape"),
        (lambda: pp.from_function(lambda p: "x", lipschitz=1.0).distance(POINTS), TypeError, "real numbers"),
    ],
)
def test_what_is_no_field_is_refused(make: Any, error: type, words: str) -> None:
    with pytest.raises(error) as caught:
        make()
    assert words in str(caught.value)


def test_a_function_that_answers_nan_is_refused() -> None:
    holed = pp.from_function(
        lambda p: np.where(p[:, 0] > 0.2, np.nan, p[:, 1]), lipschitz=1.0, bounds=[[-1, -1, -1], [1, 0, 1]]
    )
    assert holed.distance([0, 0.5, 0]) == 0.5
    with pytest.raises(ValueError, match="answers NaN at"):
        holed.distance([0.5, 0.5, 0])
    with pytest.raises(ValueError, match="answers NaN at"):
        pp.separation(holed, pp.ball(0.1).translated([0.5, 0.5, 0]))
    assert np.isnan(holed.distance([np.nan, 0, 0]))


def test_each_call_raises_what_its_own_function_raised() -> None:
    # A slot for all calls gave the exception of one thread to another.
    def raising(number: int) -> pp.Shape:
        def values(_: np.ndarray) -> np.ndarray:
            time.sleep(0.001)
            raise LookupError(number)

        return pp.from_function(values, lipschitz=1.0, bounds=[[-1, -1, -1], [1, 1, 1]])

    def ask(number: int) -> int:
        for _ in range(20):
            with pytest.raises(LookupError) as caught:
                pp.separation(raising(number), pp.ball(0.5))
            if caught.value.args != (number,):
                return caught.value.args[0]
        return number

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(ask, range(4))) == [0, 1, 2, 3]


def test_a_function_that_raises_is_called_no_more() -> None:
    calls = []

    def values(points: np.ndarray) -> np.ndarray:
        calls.append(len(points))
        raise LookupError("no")

    with pytest.raises(LookupError):
        pp.from_function(values, lipschitz=1.0, bounds=[[-1, -1, -1], [1, 1, 1]]).mass()
    assert len(calls) == 1


def test_a_function_that_asks_its_own_track_is_refused() -> None:
    # It waited for itself for ever.
    tracks: list[pp.Track] = []

    def values(points: np.ndarray) -> np.ndarray:
        tracks[0].separation()
        return np.linalg.norm(points, axis=1) - 0.5

    tracks.append(pp.Track(pp.from_function(values, lipschitz=1.0, bounds=[[-1, -1, -1], [1, 1, 1]]), pp.ball(0.1)))
    with pytest.raises(RuntimeError, match="asks the object that asks the function"):
        tracks[0].separation()


def test_no_call_has_what_functions_of_another_raise() -> None:
    # Threads of a pool that calls shared filled the bounds of a good call with NaN, or gave it the exception.
    bounds = [[-0.6] * 3, [0.6] * 3]
    good = pp.from_function(norm, lipschitz=1.0, bounds=bounds)
    bad = pp.from_function(lambda points: 1 / 0, lipschitz=1.0, bounds=bounds)
    origins = np.random.default_rng(0).normal(size=(16, 3)) * 0.1 + [0, 0, 3]
    expected = pp.cast_rays(good, origins, [0, 0, -1]).upper

    def ask(number: int) -> bool:
        if number % 2:
            with pytest.raises(ZeroDivisionError):
                pp.cast_rays(bad, origins, [0, 0, -1], threads=2)
            return True
        return np.array_equal(pp.cast_rays(good, origins, [0, 0, -1], threads=2).upper, expected)

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(ask, range(60)))


def test_a_function_that_answers_infinity_is_refused() -> None:
    endless = pp.from_function(lambda p: np.full(len(p), np.inf), lipschitz=1.0, bounds=[[-1] * 3, [1] * 3])
    with pytest.raises(ValueError, match="the function answers inf at"):
        pp.separation(endless, pp.ball(0.5))


@pytest.mark.parametrize("ask", ["mesh(cell=0.1)", "mass()", "baked(cell=0.1)", "render(width=16, height=16)"])
def test_a_function_that_asks_itself_in_other_threads_is_stopped(ask: str) -> None:
    # Each of these works in a thread of its own, where nobody counted how deep it is.
    own: list[pp.Shape] = []

    def values(points: np.ndarray) -> np.ndarray:
        eval(f"own[0].{ask}", {"own": own})
        return points[:, 0]

    own.append(pp.from_function(values, lipschitz=1.0, bounds=[[-0.6] * 3, [0.6] * 3]))
    with pytest.raises(RecursionError):
        eval(f"own[0].{ask}", {"own": own})


def test_two_tracks_that_wait_for_each_other_are_stopped() -> None:
    # Each waited for the other without looking at Ctrl-C.
    program = """
import _thread, signal, threading, numpy as np, palpate as pp
# A parent in the background lets its children ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
tracks, both = [None, None], threading.Barrier(2)
def shape(i):
    asked = []
    def values(p):
        if not asked:
            asked.append(True)
            both.wait()
            tracks[1 - i].separation()
        return np.linalg.norm(p, axis=1) - 0.5
    return pp.from_function(values, lipschitz=1, bounds=[[-0.6] * 3, [0.6] * 3])
for i in range(2):
    tracks[i] = pp.Track(shape(i), pp.ball(0.5))
threading.Thread(target=lambda: tracks[1].separation(b=[2, 0, 0]), daemon=True).start()
threading.Timer(0.5, _thread.interrupt_main).start()
try:
    tracks[0].separation(b=[2, 0, 0])
except KeyboardInterrupt:
    import os
    os._exit(7)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 7, done.stderr
