# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What the door costs: ``python benchmarks/overheads.py``, in an environment with palpate built for release.

A point that is asked for itself beside one of a large array; how long after Ctrl-C long calls end; and what
:mod:`palpate.batch` takes beyond the time that its workers spend on their chunks. The lines are keys and numbers; the last
ones are held against bars.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np

import palpate as pp
from bars import Table

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from interrupted import CALLS, delay

#: Chunks for each worker, of a second each.
CHUNKS = 20

#: Rounds, of which the best counts.
ROUNDS = 3

#: The most that a single point may take more than one of an array [s].
MORE = 1e-6

#: The latest end of a call after Ctrl-C [s].
LATEST = 0.2

#: The most that a batch may take beyond the time on its chunks, as a share of it.
SHARE = 0.02


def solid() -> pp.Shape:
    return (pp.cuboid([0.6, 0.4, 0.6]) & pp.ball(0.35)) - pp.cylinder(radius=0.1, height=1.0)


def more_for_one() -> float:
    """What a single point takes more than one of an array [s]."""
    shape, points = solid(), np.random.default_rng(7).uniform(-0.5, 0.5, (1_000_000, 3))
    few = [tuple(point) for point in points[:20_000].tolist()]
    least = [np.inf, np.inf]
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for point in few:
            shape.distance(point)
        between = time.perf_counter()
        shape.distance(points)
        end = time.perf_counter()
        least = [min(least[0], (between - start) / len(few)), min(least[1], (end - between) / len(points))]
    return least[0] - least[1]


def overhead(engine: Executor, workers: int) -> float:
    """What a batch takes beyond the time on its chunks, as a share of it; the best of some rounds."""
    peg, random = pp.cylinder(radius=0.05, height=0.2), np.random.default_rng(7)
    pilot = random.uniform(-0.5, 0.5, (2000, 3))
    start = time.perf_counter()
    pp.separations(solid(), peg, pilot, tolerance=1e-4)
    rows = round(len(pilot) / (time.perf_counter() - start))
    poses = random.uniform(-0.5, 0.5, (rows * CHUNKS * workers, 3))
    least = np.inf
    with tempfile.TemporaryDirectory() as folder:
        for i in range(ROUNDS):
            start = time.perf_counter()
            run = pp.batch.separations(
                f"{folder}/{i}", solid(), peg, poses, tolerance=1e-4, executor=engine, workers=workers, chunk=rows
            )
            took = time.perf_counter() - start
            least = min(least, took * workers / run.seconds - 1)
    return least


def dask_client(workers: int) -> object:
    from dask.distributed import Client, LocalCluster

    cluster = LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None, memory_limit=0)
    return Client(cluster)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, help="writes the numbers to a file")
    options = parser.parse_args()
    table = Table()

    def report(key: str, value: float, bar: float) -> None:
        table.report(key, value)
        table.at_most(key, bar)

    report("one.more_than_in_array.ns", 1e9 * more_for_one(), 1e9 * MORE)
    for name in CALLS:
        report(f"interrupt.{name}.s", delay(name), LATEST)
    workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    with ThreadPoolExecutor(workers) as threads:
        report("batch.threads.overhead", overhead(threads, workers), SHARE)
    with ProcessPoolExecutor(workers) as processes:
        report("batch.processes.overhead", overhead(processes, workers), SHARE)
    with dask_client(workers) as client:
        report("batch.dask.overhead", overhead(client.get_executor(retries=3), workers), SHARE)
    return table.end(options.json)


if __name__ == "__main__":
    raise SystemExit(main())
