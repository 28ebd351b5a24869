# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Signed distance functions that can be touched.

A :class:`Shape` is a body in the plane or in space, made of closed formulas: a constructor for each primitive, ``|``,
``&``, ``-`` and ``^``, and a method for each operator. Shapes are immutable. Lengths are in metres, y is up, distances
are negative inside. Points are arrays of shape (..., D), D the dimension of the shape.

>>> import palpate as pp
>>> plate = pp.cuboid([0.6, 0.4, 0.6]) - pp.cylinder(radius=0.1, height=1.0)
>>> plate.distance([0.2, 0.3, 0.0])
0.09999999999999998
>>> pp.separation(plate, pp.ball(0.05).translated([0, 0.3, 0])).lower > 0.03
True
"""

from importlib.metadata import version as _version

from palpate import _shapes, batch
from palpate._answers import (
    AtPoint,
    Body,
    BodyImpact,
    ClosestPoints,
    Contact,
    FirstTouch,
    Manifold,
    Mass,
    Neighbours,
    Overlap,
    Promise,
    RayHit,
    RayHits,
    Separation,
    Separations,
)
from palpate._errors import (
    DeviceError,
    DeviceLostError,
    Error,
    FileError,
    GridError,
    HapticsError,
    MeshError,
    MissingFileError,
    PlotError,
    QueryError,
    SceneError,
    ShapeError,
    UnknownNameError,
)
from palpate._felt import Event, Felt, HeldTool, Snapshot, Touch, Trace
from palpate._meshes import MeshContacts, MeshHits, MeshReport
from palpate._palpate import (
    STOPS,
    Figure,
    Image,
    Mailbox,
    Mesh,
    Scene,
    Servo,
    Shape,
    Track,
    World,
    cast_ray,
    cast_rays,
    closest_points,
    device_profiles,
    difference,
    feel,
    from_function,
    from_samples,
    intersection,
    manifold,
    mesh_contacts,
    mesh_hits,
    overlap,
    overlaps,
    separation,
    separations,
    smooth_difference,
    smooth_intersection,
    smooth_union,
    sweep,
    symmetric_difference,
    union,
)
from palpate._plot import plot_contacts, plot_trace
from palpate._shapes import *  # noqa: F403

__version__ = _version("palpate")

__all__ = [
    "STOPS",
    "AtPoint",
    "Body",
    "BodyImpact",
    "ClosestPoints",
    "Contact",
    "DeviceError",
    "DeviceLostError",
    "Error",
    "Event",
    "Felt",
    "Figure",
    "FileError",
    "FirstTouch",
    "GridError",
    "HapticsError",
    "HeldTool",
    "Image",
    "Mailbox",
    "Manifold",
    "Mass",
    "Mesh",
    "MeshContacts",
    "MeshHits",
    "MeshError",
    "MeshReport",
    "MissingFileError",
    "Neighbours",
    "Overlap",
    "PlotError",
    "Promise",
    "QueryError",
    "RayHit",
    "RayHits",
    "Scene",
    "SceneError",
    "Separation",
    "Separations",
    "Servo",
    "Shape",
    "ShapeError",
    "Snapshot",
    "Touch",
    "Trace",
    "Track",
    "UnknownNameError",
    "World",
    "batch",
    "cast_ray",
    "cast_rays",
    "closest_points",
    "device_profiles",
    "difference",
    "feel",
    "from_function",
    "from_samples",
    "intersection",
    "manifold",
    "mesh_contacts",
    "mesh_hits",
    "overlap",
    "overlaps",
    "plot_contacts",
    "plot_trace",
    "separation",
    "separations",
    "smooth_difference",
    "smooth_intersection",
    "smooth_union",
    "sweep",
    "symmetric_difference",
    "union",
    *_shapes.__all__,
]
