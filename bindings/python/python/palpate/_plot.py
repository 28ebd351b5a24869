# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Pictures with matplotlib, and samples for other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from palpate._felt import Felt, Trace

if TYPE_CHECKING:
    from palpate._answers import Manifold
    from palpate._meshes import MeshContacts
    from palpate._palpate import Shape

#: The axes of a plane: to the right and up, and the one along which it is placed.
AXES = {"xy": (0, 1, 2), "xz": (0, 2, 1), "yz": (1, 2, 0)}

#: Samples along the longer side of a picture.
SAMPLES = 300

#: The margin of a picture, as a share of the longer side of what it shows.
MARGIN = 0.15

#: What is shown of a shape without bounds [m].
UNBOUNDED = 1.0

#: More values are a mistake.
MOST_VALUES = 1 << 30


def _axes(plane: str, dimension: int, at: float = 0.0) -> tuple[int, int, int]:
    if plane not in AXES:
        raise ValueError(f"plane must be xy, xz or yz, got {plane!r}")
    if dimension == 2 and (plane != "xy" or at != 0.0):
        raise ValueError("in 2D there are no planes: leave plane= and at= out")
    if not np.isfinite(at):
        raise ValueError(f"at must be finite, got {at} m")
    return AXES[plane]


def _box(shape: Shape) -> NDArray[np.float64]:
    if shape.bounds is not None:
        return shape.bounds
    return np.array([[-UNBOUNDED] * shape.dimension, [UNBOUNDED] * shape.dimension])


def plot(shape: Shape, plane: str, at: float, ax: Any) -> Any:
    """Draws a cut of a shape with isolines; gives the axes."""
    import matplotlib.pyplot as plt

    right, up, along = _axes(plane, shape.dimension, at)
    low, high = _box(shape)
    margin = MARGIN * max((high - low)[[right, up]].max(), 1e-12)
    step = ((high - low)[[right, up]].max() + 2 * margin) / SAMPLES
    sides = [np.arange(low[k] - margin, high[k] + margin + step, step) for k in (right, up)]
    points = np.zeros((len(sides[1]), len(sides[0]), shape.dimension))
    if shape.dimension == 3:
        points[..., along] = at
    points[..., right], points[..., up] = np.meshgrid(*sides)
    values = shape.distance(points)
    if ax is None:
        _, ax = plt.subplots()
    ax.contourf(*sides, values, levels=[-np.inf, 0.0], colors=["#cfd8e8"])
    ax.contour(*sides, values, levels=12, colors=["#8a94a6"], linewidths=0.6)
    ax.contour(*sides, values, levels=[0.0], colors=["#1d3557"], linewidths=1.6)
    _label(ax, right, up)
    return ax


def _label(ax: Any, right: int, up: int) -> None:
    names = "xyz"
    ax.set(xlabel=f"{names[right]} [m]", ylabel=f"{names[up]} [m]", aspect="equal")


def plot_contacts(manifold: Manifold | MeshContacts, *, plane: str = "xy", ax: Any = None) -> Any:
    """Draws contacts with matplotlib: their points, and normals from the first body to the second; gives the axes.

    All contacts are drawn as seen along the third axis, however far they are from a cut.

    Raises ``ValueError`` if ``plane`` is none of xy, xz and yz, or not xy in 2D.

    >>> import matplotlib; matplotlib.use("agg")
    >>> import palpate as pp
    >>> one, two = pp.ball(0.5), pp.ball(0.5).translated([0.99, 0, 0])
    >>> ax = pp.plot_contacts(pp.manifold(one, two), ax=(one | two).plot())
    """
    import matplotlib.pyplot as plt

    points, normals = manifold.contacts.point_a, manifold.contacts.normal
    right, up, _ = _axes(plane, points.shape[1])
    if ax is None:
        _, ax = plt.subplots()
    _label(ax, right, up)
    ax.plot(points[:, right], points[:, up], "o", color="#d1495b", markersize=5)
    if len(points):
        arrows = (points[:, right], points[:, up], normals[:, right], normals[:, up])
        ax.quiver(*arrows, color="#d1495b", width=0.004)
    return ax


def plot_trace(trace: Trace | Felt, *, axes: Any = None) -> Any:
    """Draws what was felt with matplotlib, over time: the size of the force, and how deep the device was; gives two axes.

    ``trace`` is that of a servo, or what :func:`palpate.feel` gives.

    >>> import matplotlib; matplotlib.use("agg")
    >>> import palpate as pp
    >>> felt = pp.feel(pp.Scene(pp.ball(0.05)), hand=[[0, 0, 0.06, 0], [0.1, 0, 0.045, 0]], duration=0.1)
    >>> [ax.get_ylabel() for ax in pp.plot_trace(felt.trace)]
    ['force [N]', 'depth [mm]']
    """
    import matplotlib.pyplot as plt

    if isinstance(trace, Felt):
        trace = trace.trace
    if axes is None:
        _, axes = plt.subplots(2, sharex=True, layout="constrained")
    depth = np.linalg.norm(trace.device - trace.proxy, axis=1)
    for ax, values, name in (
        (axes[0], np.linalg.norm(trace.force, axis=1), "force [N]"),
        (axes[1], 1e3 * depth, "depth [mm]"),
    ):
        for point in np.unique(trace.point):
            own = trace.point == point
            ax.plot(trace.time[own], values[own], linewidth=1, label=f"point {point}")
        ax.set_ylabel(name)
    if len(np.unique(trace.point)) > 1:
        axes[0].legend()
    axes[1].set_xlabel("time [s]")
    return axes


def sample(
    shape: Shape, spacing: float, margin: float | None, threads: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """The distances at the nodes of a lattice around a shape."""
    if shape.bounds is None:
        raise ValueError("the shape has no bounds: intersect it with a box first")
    if not (spacing > 0 and np.isfinite(spacing)):
        raise ValueError(f"spacing must be positive, got {spacing} m")
    around = spacing if margin is None else margin
    if not 0 <= around < np.inf:
        raise ValueError(f"margin must be zero or more, got {around} m")
    low, high = shape.bounds[0] - around, shape.bounds[1] + around
    with np.errstate(over="ignore"):
        counts = np.ceil((high - low) / spacing - 1e-9) + 1
    if not np.prod(counts) <= MOST_VALUES:
        nodes = " × ".join(f"{count:.0f}" for count in counts)
        raise ValueError(f"{nodes} nodes are more than {MOST_VALUES}: take a larger spacing")
    first, *others = [low[k] + spacing * np.arange(int(counts[k])) for k in range(shape.dimension)]
    values = np.empty([int(count) for count in counts])
    # Points of all nodes would take several times as much memory as the values.
    slab = np.stack(np.meshgrid([0.0], *others, indexing="ij"), axis=-1)[0]
    for place, own in zip(first, values, strict=True):
        slab[..., 0] = place
        shape.distance(slab, out=own, threads=threads)
    return values, low, spacing
