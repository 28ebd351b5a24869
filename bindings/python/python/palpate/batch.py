# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Many poses or points, on any engine: threads, processes, Dask.

A run is a folder. It is cut into chunks of about a second, each of which is written whole to a file of its own; a run
that was stopped goes on where it was, whatever engine it goes on with, and the bytes are the same. Work is given to
any ``concurrent.futures.Executor``: threads by default, ``client.get_executor()`` of Dask for a cluster.

>>> import palpate as pp, numpy as np, tempfile
>>> plate, ball = pp.cuboid([1, 0.1, 1]), pp.ball(0.05)
>>> offsets = np.linspace(0, 1, 10)[:, None] * [0.0, 1.0, 0.0]
>>> run = pp.batch.separations(tempfile.mkdtemp() + "/run", plate, ball, offsets)
>>> run.table().num_rows
10
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import operator
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import lru_cache
from os import PathLike, cpu_count
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._files import claim, read, replace

__all__ = ["Run", "distances", "overlaps", "separations"]


def __dir__() -> list[str]:
    return __all__


#: Poses or points: an array, the name of a ``.npy`` file that workers can read, or a function of the first number and
#: the one after the last that gives their rows, the same ones each time.
Source: TypeAlias = "ArrayLike | str | PathLike[str] | Callable[[int, int], NDArray[Any]]"

#: How long a chunk is to take [s].
SECONDS = 1.0

#: So many rows the pilot takes at most to find that out; it takes no more after so long [s].
PILOT, PILOT_SECONDS = 1000, 0.2

#: A chunk has no more rows: those of a quarter of a second of the cheapest shapes, some 100 MB in all.
MOST_ROWS = 4_000_000

#: Files that were being written so long ago are of workers that died [s].
OLD = 3600.0

#: Chunks that wait at each worker, so that none is idle.
AHEAD = 2

#: What a run is, in its folder.
# Readers of folders of parquet files leave out names that begin so.
MANIFEST = "_manifest.json"


@dataclass(frozen=True, kw_only=True)
class Run:
    """What a batch has done, by :func:`overlaps`, :func:`separations` and :func:`distances`.

    Fields:
        folder: The folder of the run.
        count: How many rows there are.
        chunk: How many rows a chunk has.
        resumed: How many chunks were there before this call.
        seconds: The time that workers spent on the chunks of this call [s].
        undecided: How many poses this call left undecided; of separations, how many searches ended before their
            bounds were as close as was asked.

    >>> import palpate as pp, tempfile
    >>> run = pp.batch.distances(tempfile.mkdtemp() + "/run", pp.ball(0.5), [[1.5, 0, 0]])
    >>> run.count, run.resumed, run.undecided
    (1, 0, 0)
    """

    folder: Path
    count: int
    chunk: int
    resumed: int
    seconds: float
    undecided: int

    def parts(self) -> list[Path]:
        """The files of the chunks, in order.

        >>> import palpate as pp, tempfile
        >>> ball = pp.ball(0.5)
        >>> run = pp.batch.overlaps(tempfile.mkdtemp() + "/run", ball, ball, [[0.9, 0, 0], [1.1, 0, 0]])
        >>> [part.name for part in run.parts()]
        ['part-000000000000.parquet']
        """
        return [self.folder / _name(start) for start in range(0, max(self.count, 1), self.chunk)]

    def table(self) -> Any:
        """All answers as a table of pyarrow.

        >>> import palpate as pp, tempfile
        >>> ball = pp.ball(0.5)
        >>> run = pp.batch.overlaps(tempfile.mkdtemp() + "/run", ball, ball, [[0.9, 0, 0], [1.1, 0, 0]])
        >>> run.table().column("overlaps").to_pylist()
        [1, 0]
        """
        import pyarrow as pa
        import pyarrow.parquet as pq

        tables = []
        for part in self.parts():
            try:
                tables.append(pq.read_table(part, page_checksum_verification=True))
            except (OSError, ValueError) as problem:
                raise OSError(f"{part} is damaged: delete it, and make the same call again") from problem
        return pa.concat_tables(tables)


def overlaps(
    folder: str | PathLike[str],
    a: Any,
    b: Any,
    poses: Source,
    *,
    count: int | None = None,
    budget: int | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    chunk: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Run:
    """Whether two shapes overlap, with the second at each of many poses; see :func:`palpate.overlaps`.

    ``folder`` is made if it is not there; a run that is there goes on. ``count`` is how many poses a function gives.
    ``executor`` is any of ``concurrent.futures``, left out a ``ThreadPoolExecutor`` of ``workers`` threads; for others
    ``workers`` says how many work at once. ``chunk`` is how many poses a chunk has; left out, a pilot finds how many take
    a second. It asks the first poses in this process, up to 1000 for about a second, also where ``chunk`` is given: what is
    refused is refused before the run begins. ``progress`` gets how many poses are done and how many there are. Columns:
    ``overlaps``, as of :func:`palpate.overlaps`.

    Raises ``ValueError`` if the folder holds another run or a damaged one, or poses have another shape; ``TypeError`` if
    they are no numbers; ``SceneError`` if a shape cannot be written, as a function; ``OSError`` if the folder or a file
    cannot be written or read; and what a worker raises, as the first poses would here.

    >>> import palpate as pp, numpy as np, tempfile
    >>> ball = pp.ball(0.5)
    >>> offsets = np.linspace(0, 2, 100)[:, None] * [1.0, 0.0, 0.0]
    >>> pp.batch.overlaps(tempfile.mkdtemp() + "/run", ball, ball, offsets).count
    100
    """
    job = {"kind": "overlaps", "a": _shape(a), "b": _shape(b), "budget": _whole(budget)}
    return _run(folder, job, poses, count, executor, workers, chunk, progress)


def separations(
    folder: str | PathLike[str],
    a: Any,
    b: Any,
    poses: Source,
    *,
    tolerance: float | None = None,
    count: int | None = None,
    budget: int | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    chunk: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Run:
    """How far apart two shapes are, with the second at each of many poses; see :func:`palpate.separations`.

    The other arguments and what is raised are those of :func:`overlaps`. Columns: ``lower``, ``upper``, ``stop``, ``evaluations``.

    >>> import palpate as pp, tempfile
    >>> ball = pp.ball(0.5)
    >>> run = pp.batch.separations(tempfile.mkdtemp() + "/run", ball, ball, [[1.5, 0, 0]])
    >>> round(run.table().column("upper")[0].as_py(), 3)
    0.5
    """
    job = {
        "kind": "separations",
        "a": _shape(a),
        "b": _shape(b),
        "tolerance": None if tolerance is None else float(tolerance),
        "budget": _whole(budget),
    }
    return _run(folder, job, poses, count, executor, workers, chunk, progress)


def distances(
    folder: str | PathLike[str],
    shape: Any,
    points: Source,
    *,
    count: int | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    chunk: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Run:
    """The distances at many points. The arguments and what is raised are those of :func:`overlaps`. Columns: ``distance``.

    >>> import palpate as pp, tempfile
    >>> run = pp.batch.distances(tempfile.mkdtemp() + "/run", pp.ball(0.5), [[1.5, 0, 0]])
    >>> run.table().column("distance").to_pylist()
    [1.0]
    """
    return _run(folder, {"kind": "distances", "a": _shape(shape)}, points, count, executor, workers, chunk, progress)


def _shape(shape: Any) -> list[Any]:
    from palpate._palpate import Shape

    if not isinstance(shape, Shape):
        raise TypeError(f"a batch asks shapes, got a {type(shape).__name__}")
    return [shape.to_json(), shape.dimension]


def _whole(budget: int | None) -> int | None:
    return None if budget is None else operator.index(budget)


@lru_cache(maxsize=8)
def _made(text: str, dimension: int) -> Any:
    from palpate._palpate import Shape

    return Shape.from_json(text, dimension=dimension)


def _columns(job: dict[str, Any], rows: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """The answers for some rows."""
    from palpate import _palpate

    a = _made(*job["a"])
    if job["kind"] == "distances":
        return {"distance": a.distance(rows)}
    b = _made(*job["b"])
    if job["kind"] == "overlaps":
        return {"overlaps": _palpate.overlaps(a, b, rows, budget=job["budget"])}
    found = _palpate.separations(a, b, rows, tolerance=job["tolerance"], budget=job["budget"])
    return {
        "lower": found.lower,
        "upper": found.upper,
        "stop": found.stops,
        "evaluations": found.evaluations,
    }


def _undecided(columns: dict[str, NDArray[Any]]) -> int:
    if "overlaps" in columns:
        return int((columns["overlaps"] == -1).sum())
    from palpate._palpate import STOPS

    if "stop" not in columns:
        return 0
    decided = [STOPS.index(name) for name in ("converged", "sign_known")]
    return int((~np.isin(columns["stop"], decided)).sum())


def _name(start: int) -> str:
    return f"part-{start:012d}.parquet"


def _rows(source: Any, start: int, stop: int) -> NDArray[Any]:
    if isinstance(source, str):
        rows = np.array(np.load(source, mmap_mode="r")[start:stop])
    else:
        rows = np.asarray(source(start, stop) if callable(source) else source)
    if len(rows) != stop - start:
        raise ValueError(f"rows {start} to {stop} are {stop - start}, the source gave {len(rows)}")
    return rows


def _digest(job: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(job, sort_keys=True).encode()).hexdigest()


@lru_cache(maxsize=8)
def _job(folder: str, digest: str) -> dict[str, Any]:
    """The job of a run, from its manifest: once in each worker."""
    job = json.loads(read(Path(folder) / MANIFEST))["job"]
    if _digest(job) != digest:
        raise ValueError(f"{Path(folder) / MANIFEST} is not that of this run: was the folder replaced meanwhile?")
    return dict(job)


def _note(error: BaseException, text: str) -> None:
    """Adds a note, which Python 3.10 shows as a warning."""
    if sys.version_info >= (3, 11):
        error.add_note(text)
    else:
        warnings.warn(text, stacklevel=3)


def _work(folder: str, digest: str, source: Any, start: int, stop: int) -> tuple[int, float, int]:
    """Answers a chunk and writes it whole; in a worker."""
    import io

    import pyarrow as pa
    import pyarrow.parquet as pq

    begin = time.perf_counter()
    try:
        columns = _columns(_job(folder, digest), _rows(source, start, stop))
    except Exception as error:
        _note(error, f"in the chunk of rows {start} to {stop}, which are counted from 0 within it")
        raise
    table = pa.table(columns).replace_schema_metadata(_mark(digest, start))
    out = io.BytesIO()
    pq.write_table(table, out, compression="zstd", write_page_checksum=True)
    replace(Path(folder) / _name(start), out.getvalue())
    return stop - start, time.perf_counter() - begin, _undecided(columns)


def _mark(digest: str, start: int) -> dict[bytes, bytes]:
    """What a part says that it is."""
    return {b"palpate": digest.encode(), b"start": str(start).encode()}


def _is_there(place: Path, digest: str, start: int, rows: int) -> bool:
    """Whether a part is there and whole, and of this chunk of this run."""
    import pyarrow.parquet as pq

    part = place / _name(start)
    try:
        found = pq.read_metadata(part)
    except (OSError, ValueError):
        return False
    own = found.metadata or {}
    return bool(found.num_rows == rows and _mark(digest, start).items() <= own.items())


def _source(source: Source, count: int | None) -> tuple[Any, int, dict[str, Any]]:
    """The source as workers take it, how many rows it has, and what it is known by."""
    if callable(source):
        if count is None:
            raise TypeError("count= must say how many rows the function gives")
        first = np.ascontiguousarray(source(0, min(count, PILOT)))
        form = {"rows": count, "dtype": first.dtype.str, "shape": list(first.shape[1:])}
        return source, count, {**form, "first": hashlib.sha256(first.tobytes()).hexdigest()}
    if isinstance(source, (str, PathLike)):
        file = str(Path(source).resolve())
        rows = np.load(file, mmap_mode="r")
        _check(rows)
        state = Path(file).stat()
        known = {"rows": len(rows), "size": state.st_size, "changed": state.st_mtime_ns}
        return file, len(rows), known
    if isinstance(source, np.ma.MaskedArray):
        raise TypeError("rows must not be a masked array: fill it first, by .filled(…)")
    rows = np.asarray(source)
    _check(rows)
    # A copy: what the caller does with the array meanwhile changes nothing.
    whole = np.array(rows, order="C")
    array = {"rows": len(whole), "dtype": whole.dtype.str, "shape": list(whole.shape)}
    return whole, len(whole), {**array, "digest": hashlib.sha256(whole.tobytes()).hexdigest()}


def _check(rows: NDArray[Any]) -> None:
    if rows.dtype.kind not in "fiu" or rows.ndim < 2:
        raise TypeError(f"rows must be an array of numbers with an axis of rows, got {rows.dtype} of {rows.shape}")


def _pilot(job: dict[str, Any], source: Any, count: int) -> int:
    """How many rows take about a second, by answering the first ones here, more and more."""
    import pyarrow as pa

    rows = min(1, count)
    while True:
        own = source if callable(source) or isinstance(source, str) else source[:rows]
        some = _rows(own, 0, rows)
        begin = time.perf_counter()
        pa.table(_columns(job, some))
        spent = time.perf_counter() - begin
        if rows == min(PILOT, count) or spent > PILOT_SECONDS:
            break
        rows = min(10 * rows, PILOT, count)
    each = max(spent / max(rows, 1), 1e-9)
    # Two digits are enough, and say that no more is known.
    wanted = SECONDS / each
    unit = 10.0 ** max(math.floor(math.log10(max(wanted, 1.0))) - 1, 0)
    return min(max(int(wanted / unit) * int(unit), 1), MOST_ROWS)


def _run(
    folder: str | PathLike[str],
    job: dict[str, Any],
    source: Source,
    count: int | None,
    executor: Executor | None,
    workers: int | None,
    chunk: int | None,
    progress: Callable[[int, int], None] | None,
) -> Run:
    if workers is not None and workers < 1:
        raise ValueError(f"workers must be at least 1, got {workers}")
    if chunk is not None:
        chunk = operator.index(chunk)
    if count is not None:
        count = operator.index(count)
        if count < 0:
            raise ValueError(f"count must be at least 0, got {count}")
    try:
        import pyarrow  # noqa: F401
    except ImportError as problem:
        raise ImportError("batches need pyarrow: pip install 'palpate[batch]'") from problem
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    given, rows, known = _source(source, count)
    if count is not None and count != rows:
        raise ValueError(f"the source has {rows} rows, count is {count}")
    chunk = _agreed(place, job, known, given, rows, chunk)
    _tidy(place)
    # Without rows there is one part, which has the columns.
    starts, digest = range(0, max(rows, 1), chunk), _digest(job)
    waiting = [
        start for start in starts if not _is_there(place, digest, start, min(chunk, rows - start))
    ]
    resumed = len(starts) - len(waiting)
    done, seconds, undecided = rows - sum(min(chunk, rows - start) for start in waiting), 0.0, 0
    own = ThreadPoolExecutor(workers) if executor is None else None
    engine = own if executor is None else executor
    assert engine is not None
    many = AHEAD * (workers or _workers(engine))
    try:
        for size, spent, open_ in _asked(engine, many, str(place), digest, given, waiting, chunk, rows):
            done, seconds, undecided = done + size, seconds + spent, undecided + open_
            if progress:
                progress(done, rows)
    except BaseException as stopped:
        _note(stopped, f"{place} keeps {done} of {rows} rows: the same call goes on from there")
        raise
    finally:
        if own:
            own.shutdown(wait=True, cancel_futures=True)
    return Run(
        folder=place, count=rows, chunk=chunk, resumed=resumed, seconds=seconds, undecided=undecided
    )


def _tidy(place: Path) -> None:
    """Removes what dead workers and drivers left half written."""
    for left in [*place.glob(".part-*"), *place.glob(f".{MANIFEST}.*")]:
        # Workers of another driver that live rename theirs meanwhile.
        with contextlib.suppress(FileNotFoundError):
            if time.time() - left.stat().st_mtime > OLD:
                left.unlink()


def _workers(engine: Executor) -> int:
    """How many work at once: of a cluster nobody says it, so that there is work for many."""
    if isinstance(engine, ThreadPoolExecutor):
        return engine._max_workers
    return max(64, cpu_count() or 1)


def _asked(
    engine: Executor,
    many: int,
    folder: str,
    digest: str,
    source: Any,
    waiting: list[int],
    chunk: int,
    rows: int,
) -> Iterator[tuple[int, float, int]]:
    """Gives chunks to the engine, so many at once, and what they say as they are done."""
    open_: set[Future[tuple[int, float, int]]] = set()
    chunks = iter(waiting)
    try:
        while True:
            while len(open_) < many:
                start = next(chunks, None)
                if start is None:
                    break
                stop = min(start + chunk, rows)
                own = source[start:stop] if isinstance(source, np.ndarray) else source
                open_.add(engine.submit(_work, folder, digest, own, start, stop))
            if not open_:
                return
            ready, open_ = wait(open_, return_when=FIRST_COMPLETED)
            for future in ready:
                yield future.result()
    finally:
        for future in open_:
            future.cancel()


def _agreed(
    place: Path,
    job: dict[str, Any],
    known: dict[str, Any],
    source: Any,
    rows: int,
    chunk: int | None,
) -> int:
    """The rows of a chunk, that of the run that is in the folder if there is one. Anything else that differs is refused."""
    from importlib.metadata import version

    if chunk is not None and chunk < 1:
        raise ValueError(f"chunk must be at least 1, got {chunk}")
    wanted = {"job": job, "source": known, "version": version("palpate")}
    file = place / MANIFEST
    if not file.exists():
        if any(place.glob("part-*")):
            raise ValueError(f"{place} holds parts without {MANIFEST}: take another folder")
        # Asked also where the caller says the chunk: a setting that is refused must not become what the run is.
        size = _pilot(job, source, rows)
        size = chunk if chunk is not None else size
        # Of several drivers that begin at once, one says what the run is.
        if claim(file, json.dumps({**wanted, "chunk": size}, indent=1).encode()):
            return size
    try:
        there = json.loads(read(file))
        size = there["chunk"]
        if type(size) is not int or size < 1:
            raise ValueError(f"chunk is {size!r}")
    except (ValueError, KeyError, TypeError, RecursionError) as problem:
        raise ValueError(f"{file} is damaged ({problem}): delete {place}, or take another folder") from problem
    for key, value in wanted.items():
        if there.get(key) != json.loads(json.dumps(value)):
            raise ValueError(
                f"{place} holds another run: its {key} differs. Take another folder, or delete this one"
            )
    if chunk is not None and chunk != size:
        raise ValueError(f"{place} holds a run with chunks of {size} rows, not {chunk}")
    return size
