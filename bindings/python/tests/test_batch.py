# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Batches: the same answers whatever the engine, the chunks and the deaths on the way."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import palpate as pp
import pytest

PLATE = pp.cuboid([0.6, 0.4, 0.6]) - pp.cylinder(radius=0.1005, height=1.0)
PEG = pp.cylinder(radius=0.1, height=0.6)
COUNT = 4000


def poses(start: int, stop: int) -> np.ndarray:
    """Poses by their numbers: chunks of any size have the same ones."""
    numbers = np.arange(start, stop, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    share = [(numbers >> np.uint64(shift)).astype(np.uint32) / 2**32 for shift in (0, 11, 22)]
    return np.stack(share, axis=1) - 0.5


def answers(run: pp.batch.Run) -> bytes:
    return run.table().column("overlaps").to_numpy().tobytes()


TRUTH = pp.overlaps(PLATE, PEG, poses(0, COUNT)).tobytes()


def test_engines_and_chunks_give_the_same_bytes(tmp_path: Path) -> None:
    np.save(tmp_path / "poses.npy", poses(0, COUNT))
    sources: dict[str, Any] = {
        "array": poses(0, COUNT),
        "function": poses,
        "file": tmp_path / "poses.npy",
    }
    for (name, source), chunk in zip(sources.items(), [None, 700, 4000], strict=True):
        run = pp.batch.overlaps(tmp_path / name, PLATE, PEG, source, count=COUNT, chunk=chunk)
        assert answers(run) == TRUTH and run.count == COUNT
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        run = pp.batch.overlaps(
            tmp_path / "processes", PLATE, PEG, poses(0, COUNT), chunk=900, executor=processes
        )
    assert answers(run) == TRUTH


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL on this system")
def test_a_worker_of_dask_is_killed(tmp_path: Path) -> None:
    from distributed import Client, LocalCluster

    options: dict[str, Any] = {"dashboard_address": None, "memory_limit": 0}
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, **options) as cluster,
        Client(cluster) as client,
    ):
        workers = list(client.run(os.getpid).values())
        killed: list[int] = []

        def progress(done: int, _all: int) -> None:
            if done > COUNT / 3 and not killed:
                killed.append(workers[0])
                os.kill(workers[0], signal.SIGKILL)

        run = pp.batch.overlaps(
            tmp_path / "run",
            PLATE,
            PEG,
            poses(0, COUNT),
            chunk=100,
            executor=client.get_executor(retries=3),
            workers=2,
            progress=progress,
        )
        assert killed and answers(run) == TRUTH


DRIVER = """
import sys
import numpy as np
sys.path.insert(0, {tests!r})
import palpate as pp
from test_batch import PLATE, PEG, poses, COUNT
pp.batch.overlaps({folder!r}, PLATE, PEG, poses(0, COUNT), chunk=50, workers=1)
"""


def test_a_driver_is_killed_and_another_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    text = DRIVER.format(tests=str(Path(__file__).parent), folder=str(folder))
    driver = subprocess.Popen([sys.executable, "-c", text])
    until = time.monotonic() + 120
    while len(list(folder.glob("part-*"))) < 5:
        assert time.monotonic() < until and driver.poll() is None
        time.sleep(0.001)
    driver.kill()
    driver.wait()
    before = {part.name: part.stat().st_mtime_ns for part in folder.glob("part-*")}
    run = pp.batch.overlaps(folder, PLATE, PEG, poses(0, COUNT))
    assert answers(run) == TRUTH and run.chunk == 50 and run.resumed == len(before)
    # What was there was not made again.
    after = {part.name: part.stat().st_mtime_ns for part in folder.glob("part-*")}
    assert before.items() <= after.items()
    again = pp.batch.overlaps(folder, PLATE, PEG, poses(0, COUNT))
    assert again.resumed == len(after) and again.seconds == 0


def test_a_run_with_anything_different_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    pp.batch.overlaps(folder, PLATE, PEG, poses(0, 100), chunk=60)
    for other, words in [
        ({"a": PLATE.scaled(2)}, "its job differs"),
        ({"poses": poses(1, 101)}, "its source differs"),
        ({"budget": 100}, "its job differs"),
        ({"chunk": 50}, "chunks of 60 rows, not 50"),
    ]:
        asked: dict[str, Any] = {"a": PLATE, "b": PEG, "poses": poses(0, 100)} | other
        with pytest.raises(ValueError, match=words):
            pp.batch.overlaps(folder, **asked)
    (folder / "_manifest.json").unlink()
    with pytest.raises(ValueError, match="holds parts without _manifest.json"):
        pp.batch.overlaps(folder, PLATE, PEG, poses(0, 100))


def test_drivers_that_begin_at_once_agree_on_one_run(tmp_path: Path) -> None:
    from concurrent.futures import ThreadPoolExecutor

    def drive(chunk: int) -> object:
        try:
            return pp.batch.overlaps(tmp_path / "run", PLATE, PEG, poses(0, 500), chunk=chunk)
        except ValueError as error:
            return error

    with ThreadPoolExecutor(4) as drivers:
        runs = list(drivers.map(drive, [100, 170, 60, 250]))
    [run] = [run for run in runs if isinstance(run, pp.batch.Run)]
    assert all("holds a run with chunks of" in str(run) for run in runs if isinstance(run, ValueError))
    assert sorted(part.name for part in (tmp_path / "run").glob("part-*")) == [part.name for part in run.parts()]


def test_a_part_that_is_cut_short_or_of_another_chunk_is_made_again(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    parts = pp.batch.overlaps(folder, PLATE, PEG, poses(0, COUNT), chunk=1000).parts()
    parts[0].write_bytes(parts[0].read_bytes()[:40])
    parts[1].write_bytes(b"")
    parts[2].write_bytes(parts[3].read_bytes())
    again = pp.batch.overlaps(folder, PLATE, PEG, poses(0, COUNT))
    assert again.resumed == 1 and answers(again) == TRUTH


def test_a_source_of_other_numbers_in_the_same_bytes_is_refused(tmp_path: Path) -> None:
    points = np.arange(30, dtype="i8").reshape(10, 3)
    pp.batch.distances(tmp_path / "run", PLATE, points)
    for other in [points.view("f8"), points.view(">i8"), points.reshape(5, 2, 3)]:
        with pytest.raises(ValueError, match="its source differs"):
            pp.batch.distances(tmp_path / "run", PLATE, other)


def test_other_questions(tmp_path: Path) -> None:
    run = pp.batch.separations(tmp_path / "s", PLATE, PEG, poses(0, 200), tolerance=1e-4)
    truth = pp.separations(PLATE, PEG, poses(0, 200), tolerance=1e-4)
    assert np.array_equal(run.table().column("lower").to_numpy(), truth.lower)
    points = poses(0, 5000).astype(np.float32)
    run = pp.batch.distances(tmp_path / "d", PLATE, points, chunk=1234)
    assert np.array_equal(run.table().column("distance").to_numpy(), PLATE.distance(points))
    empty = pp.batch.distances(tmp_path / "e", PLATE, np.zeros((0, 3)))
    assert empty.count == 0 and len(empty.parts()) == 1


def test_what_is_no_batch_is_refused(tmp_path: Path) -> None:
    for asked, error, words in [
        ({"points": poses}, TypeError, "count= must say"),
        ({"points": np.zeros(3)}, TypeError, "an axis of rows"),
        ({"points": np.zeros((4, 2))}, ValueError, "points must have the shape"),
        ({"points": poses, "count": 10, "chunk": 0}, ValueError, "chunk must be at least 1"),
        ({"points": poses, "count": 10, "workers": -1}, ValueError, "workers must be at least 1"),
        ({"points": poses, "count": 10, "chunk": 1.5}, TypeError, "float"),
        ({"points": poses, "count": -5}, ValueError, "count must be at least 0"),
        ({"points": np.zeros((4, 2, 3))}, ValueError, "1-dimensional"),
        ({"points": np.ma.masked_greater(np.zeros((4, 3)), 1)}, TypeError, "masked array"),
        ({"points": lambda start, stop: np.zeros((1, 3)), "count": 10}, ValueError, "the source gave 1"),
    ]:
        with pytest.raises(error, match=words):
            pp.batch.distances(tmp_path / words.replace(" ", "-"), PLATE, **asked)


def test_what_is_refused_leaves_no_run(tmp_path: Path) -> None:
    ball, poses = pp.ball(0.5), np.zeros((10, 3))
    for settings in ({"tolerance": -1.0}, {"tolerance": float("nan")}):
        with pytest.raises((ValueError, pp.Error)):
            pp.batch.separations(tmp_path / "run", ball, ball, poses, chunk=5, **settings)
    with pytest.raises(ValueError, match="10 rows, count is 9"):
        pp.batch.separations(tmp_path / "run", ball, ball, poses, chunk=5, count=9)
    good = pp.batch.separations(
        tmp_path / "run", ball, ball, poses, chunk=5, tolerance=np.float32(1e-3), budget=np.int64(1000)
    )
    assert good.resumed == 0 and good.table().num_rows == 10
    (tmp_path / "run" / "_manifest.json").write_text("{")
    with pytest.raises(ValueError, match="manifest.json is damaged"):
        pp.batch.separations(tmp_path / "run", ball, ball, poses)


def test_no_rows_are_a_table_without_rows(tmp_path: Path) -> None:
    table = pp.batch.distances(tmp_path / "run", pp.ball(0.5), np.zeros((0, 3))).table()
    assert table.num_rows == 0 and table.column_names == ["distance"]


def test_an_error_says_that_the_same_call_goes_on(tmp_path: Path) -> None:
    def stop(done: int, rows: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        pp.batch.distances(tmp_path / "run", pp.ball(0.5), np.zeros((10, 3)), chunk=5, workers=1, progress=stop)
    if sys.version_info >= (3, 11):
        assert "keeps 5 of 10 rows" in stopped.value.__notes__[0]


def test_a_folder_is_a_table_of_pandas(tmp_path: Path) -> None:
    # The manifest, which is no parquet file, was read as one.
    import pandas

    pp.batch.distances(tmp_path / "run", PLATE, poses(0, 100), chunk=30)
    assert len(pandas.read_parquet(tmp_path / "run")) == 100


def test_a_part_that_is_damaged_within_is_told(tmp_path: Path) -> None:
    run = pp.batch.distances(tmp_path / "run", PLATE, poses(0, 1000), chunk=500)
    part = run.parts()[1]
    whole = bytearray(part.read_bytes())
    whole[100] ^= 0xFF
    part.write_bytes(whole)
    with pytest.raises(OSError, match="is damaged: delete it, and make the same call again"):
        run.table()
    part.unlink()
    assert pp.batch.distances(tmp_path / "run", PLATE, poses(0, 1000)).resumed == 1


@pytest.mark.parametrize("chunk", ["-5", "0", "true", "10.7", '"10"'])
def test_a_manifest_with_another_chunk_is_damaged(tmp_path: Path, chunk: str) -> None:
    # One of -5 had no parts, and was done.
    pp.batch.distances(tmp_path / "run", PLATE, poses(0, 100), chunk=30)
    manifest = tmp_path / "run" / "_manifest.json"
    manifest.write_text(manifest.read_text().replace('"chunk": 30', f'"chunk": {chunk}'))
    with pytest.raises(ValueError, match="is damaged"):
        pp.batch.distances(tmp_path / "run", PLATE, poses(0, 100))


def test_what_another_worker_renames_meanwhile_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Its file was gone between the list of the folder and the look at it.
    (tmp_path / ".part-1").write_text("")
    real = Path.glob

    def glob(self: Path, pattern: str) -> Any:
        found = list(real(self, pattern))
        (tmp_path / ".part-1").unlink(missing_ok=True)
        return found

    monkeypatch.setattr(Path, "glob", glob)
    assert pp.batch.distances(tmp_path, PLATE, poses(0, 100), chunk=30).count == 100
