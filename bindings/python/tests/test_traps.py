# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What other packages trip over: forks, Ctrl-C, panics, the interpreter's lock."""

from __future__ import annotations

import multiprocessing
import random
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import palpate as pp
import pytest
from interrupted import CALLS, delay

S = (pp.ball(0.5) & pp.cuboid([0.8, 0.8, 0.8])) - pp.cylinder(radius=0.2, height=2.0)


def asked(_: int) -> float:
    """A call that uses threads."""
    points = np.random.default_rng(1).uniform(-1, 1, (100_000, 3))
    found = pp.separations(S, pp.ball(0.1), points[:50], threads=2)
    # What bakes and draws shared the threads of all processors, which a child of fork waited for without end.
    baked = S.baked(cell=0.05, threads=2)
    again = pp.Shape.from_json(pp.ball(0.3).baked(cell=0.05).to_json())
    drawn = pp.ball(0.5).render(width=40, height=30, threads=2).pixels.sum()
    grids = baked.distance(points).sum() + again.distance(points).sum() + drawn
    return float(S.distance(points, threads=2).sum() + found.lower.sum() + grids)


# A process that has threads may deadlock where it forks: that is what is tested.
@pytest.mark.filterwarnings("ignore:.*multi-threaded:DeprecationWarning")
@pytest.mark.parametrize("way", multiprocessing.get_all_start_methods())
def test_processes_after_threads(way: str) -> None:
    here = asked(0)
    with multiprocessing.get_context(way).Pool(2) as pool:
        assert pool.map_async(asked, [0, 1]).get(timeout=120) == [here, here]


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot send itself Ctrl-C there")
@pytest.mark.parametrize("name", CALLS)
def test_a_long_call_is_stopped(name: str) -> None:
    # It stops long before its end; `benchmarks/overheads.py` measures how soon.
    assert delay(name) < 30


AT_EXIT = """
import threading, time
import numpy as np
import palpate as pp

ball = pp.ball(0.1)
function = pp.from_function(lambda points: np.linalg.norm(points, axis=1) - 0.1, dimension=3, lipschitz=1)
points = np.random.default_rng(1).random((300_000, 3))
begun = threading.Barrier(5)

def work():
    begun.wait()
    while True:
        {call}

for _ in range(4):
    threading.Thread(target=work, daemon=True).start()
begun.wait()
time.sleep(0.2)
"""

CALLS_AT_EXIT = {
    "the core": "ball.distance(points)",
    "threads of the core": "ball.distance(points, threads=2)",
    "a function": "function.distance(points)",
    "threads that call a function": "function.distance(points, threads=2)",
    "one point after another": "ball.distance([0, 0, 1])",
    "a search": "pp.separation(ball, pp.ball(0.1).translated([1, 0, 0]))",
    "a search over a function": "pp.separation(function, pp.ball(0.1).translated([1, 0, 0]))",
}


# The interpreter unwound the threads, which aborted the process or read memory that was freed.
@pytest.mark.parametrize("call", CALLS_AT_EXIT.values(), ids=CALLS_AT_EXIT.keys())
def test_daemon_threads_do_not_abort_the_end(call: str) -> None:
    program = [sys.executable, "-c", AT_EXIT.format(call=call)]
    for _ in range(3):
        done = subprocess.run(program, capture_output=True, text=True, timeout=60, check=False)
        assert (done.returncode, done.stderr) == (0, "")


# What is registered before palpate is called after its own end.
def test_calls_at_the_very_end_are_answered() -> None:
    program = """
import atexit
@atexit.register
def last():
    function = pp.from_function(lambda points: points[:, 0] - 1, dimension=3, lipschitz=1)
    print(pp.ball(0.5).distance([1, 0, 0]), function.distance([3, 0, 0]))
import palpate as pp
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "0.5 2.0\n", "")


def test_a_second_thread_goes_on() -> None:
    counted = 0
    is_over = threading.Event()

    def count() -> None:
        nonlocal counted
        while not is_over.is_set():
            counted += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    S.distance(np.zeros((2_000_000, 3)))
    during = counted - before
    is_over.set()
    thread.join()
    assert during > 0


VALUES: list[Any] = [
    None, True, 0, 1, -1, 2, 3, 10**30, 0.0, -0.0, 0.5, -0.5, 1e-300, 1e300, np.nan, np.inf, "x", "", b"x", [], [0], [0, 0],
    [0, 0, 0], [1, 2, 3], [0.1, 0.2, 0.3, 0.4], [[0, 0, 0]], [[0, 0], [1, 0], [0, 1]], [[[0, 0], [1, 0], [0, 1]]], (), {},
    {"spacing": 1.0}, {"spacing": 1.0, "first": 0, "last": 3}, np.zeros((0, 3)), np.zeros((2, 3), np.float32), np.eye(4),
    np.eye(3), np.full(3, np.nan), object(), S, pp.ball(0.3, dimension=2), pp.Scene(S), pp.ball(0.2).mesh(cell=0.1),
    lambda *_: 0, "omega", "quadratic", "xy", 1e9, 5, 7, np.float32(0.5), np.int8(3),
]  # fmt: skip

LEFT_OUT = {"baked", "render", "feel", "Servo", "batch", "plot_contacts", "main", "save", "mesh", "sample", "figure", "plot", "mass"}


def test_no_call_panics() -> None:
    random_ = random.Random(5)
    names = [name for name in pp.__all__ if callable(getattr(pp, name)) and name not in LEFT_OUT]
    methods = [name for name in dir(S) if not name.startswith("_") and callable(getattr(S, name)) and name not in LEFT_OUT]
    shapes = [S, pp.ball(0.3, dimension=2), pp.half_space([0, 1, 0], 0.0)]
    counts = {"answers": 0, "refusals": 0}
    for _ in range(20_000):
        if random_.random() < 0.5:
            call = getattr(pp, random_.choice(names))
        else:
            call = getattr(random_.choice(shapes), random_.choice(methods))
        given = [random_.choice(VALUES) for _ in range(random_.randrange(4))]
        named = {
            name: random_.choice(VALUES)
            for name in random_.sample(["width", "profile", "tolerance", "degrees", "matrix", "out", "height", "margin"], random_.randrange(2))
        }
        if call in (pp.separation, pp.closest_points, pp.manifold, pp.mesh_contacts, pp.separations):
            named["budget"] = 1000
        try:
            answer = call(*given, **named)
        except (pp.Error, TypeError, ValueError, OverflowError, AttributeError, OSError):
            counts["refusals"] += 1
        else:
            counts["answers"] += 1
            if isinstance(answer, pp.Shape):
                shapes = (shapes + [answer])[-20:] if answer.promise.bounds is None or len(repr(answer)) < 2000 else shapes
    assert counts["answers"] > 500 and counts["refusals"] > 500
