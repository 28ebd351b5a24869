# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What is made in Rust. Docstrings are in the module itself."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate._answers import (
    AtPoint,
    ClosestPoints,
    FirstTouch,
    Manifold,
    Mass,
    Overlap,
    PenetrationBounds,
    Promise,
    RayCast,
    Separation,
)
from palpate._felt import Event, Felt, Snapshot, Trace
from palpate._many import Body, BodyImpact, Neighbours, RayHits, Separations
from palpate._meshes import MeshContacts, MeshHits, MeshReport
from palpate._types import Plane, Profile, Row

STOPS: tuple[str, ...]

__all__ = [
    "STOPS",
    "Figure",
    "Image",
    "Mailbox",
    "Mesh",
    "Scene",
    "Servo",
    "Shape",
    "Track",
    "World",
    "cast_ray",
    "cast_rays",
    "catalogue",
    "closest_points",
    "device_profiles",
    "difference",
    "feel",
    "from_function",
    "from_samples",
    "intersection",
    "main",
    "manifold",
    "mesh_contacts",
    "mesh_hits",
    "overlap",
    "overlaps",
    "penetration",
    "primitive",
    "separation",
    "separations",
    "smooth_difference",
    "smooth_intersection",
    "smooth_union",
    "sweep",
    "symmetric_difference",
    "union",
]

@final
class Shape:
    @property
    def dimension(self) -> int: ...
    @property
    def promise(self) -> Promise: ...
    @property
    def bounds(self) -> NDArray[np.float64] | None: ...
    @overload
    def distance(self, points: Sequence[float], *, threads: int = 1) -> float: ...
    @overload
    def distance(
        self,
        points: NDArray[np.float32],
        *,
        out: NDArray[np.float32] | None = None,
        threads: int = 1,
    ) -> NDArray[np.float32]: ...
    @overload
    def distance(
        self, points: ArrayLike, *, out: NDArray[Any] | None = None, threads: int = 1
    ) -> Any: ...
    @overload
    def __call__(self, points: Sequence[float], *, threads: int = 1) -> float: ...
    @overload
    def __call__(
        self,
        points: NDArray[np.float32],
        *,
        out: NDArray[np.float32] | None = None,
        threads: int = 1,
    ) -> NDArray[np.float32]: ...
    @overload
    def __call__(
        self, points: ArrayLike, *, out: NDArray[Any] | None = None, threads: int = 1
    ) -> Any: ...
    def gradient(
        self, points: ArrayLike, *, out: NDArray[Any] | None = None, threads: int = 1
    ) -> NDArray[Any]: ...
    def distance_gradient(
        self,
        points: ArrayLike,
        *,
        out: tuple[NDArray[Any] | None, NDArray[Any] | None] | None = None,
        threads: int = 1,
    ) -> tuple[Any, NDArray[Any]]: ...
    def at(self, point: ArrayLike) -> AtPoint: ...
    def to_json(self) -> str: ...
    @staticmethod
    def from_json(text: str, *, dimension: int = 3) -> Shape: ...
    def __or__(self, other: Shape, /) -> Shape: ...
    def __ror__(self, other: Shape, /) -> Shape: ...
    def __and__(self, other: Shape, /) -> Shape: ...
    def __rand__(self, other: Shape, /) -> Shape: ...
    def __sub__(self, other: Shape, /) -> Shape: ...
    def __rsub__(self, other: Shape, /) -> Shape: ...
    def __xor__(self, other: Shape, /) -> Shape: ...
    def __rxor__(self, other: Shape, /) -> Shape: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def union(self, *others: Shape | Iterable[Shape]) -> Shape: ...
    def intersection(self, *others: Shape | Iterable[Shape]) -> Shape: ...
    def difference(self, *others: Shape | Iterable[Shape]) -> Shape: ...
    def symmetric_difference(self, *others: Shape | Iterable[Shape]) -> Shape: ...
    def smooth_union(
        self, *others: Shape | Iterable[Shape], width: float, profile: Profile = "quadratic"
    ) -> Shape: ...
    def smooth_intersection(
        self, *others: Shape | Iterable[Shape], width: float, profile: Profile = "quadratic"
    ) -> Shape: ...
    def smooth_difference(
        self, *others: Shape | Iterable[Shape], width: float, profile: Profile = "quadratic"
    ) -> Shape: ...
    def displaced(self, by: Shape, *, height: float) -> Shape: ...
    def morphed(self, into: Shape, *, progress: float) -> Shape: ...
    def translated(self, offset: ArrayLike) -> Shape: ...
    def rotated(
        self,
        axis: ArrayLike | None = None,
        *,
        degrees: float | None = None,
        radians: float | None = None,
        quaternion: ArrayLike | None = None,
        matrix: ArrayLike | None = None,
    ) -> Shape: ...
    def placed(self, pose: ArrayLike) -> Shape: ...
    def scaled(self, factor: float) -> Shape: ...
    def stretched(self, factors: ArrayLike) -> Shape: ...
    def offset(self, distance: float) -> Shape: ...
    def shell(self, thickness: float) -> Shape: ...
    def elongated(self, lengths: ArrayLike) -> Shape: ...
    def mirrored(self, axis: Literal["x", "y", "z"]) -> Shape: ...
    def repeated(
        self,
        *,
        x: float | Row | None = None,
        y: float | Row | None = None,
        z: float | Row | None = None,
    ) -> Shape: ...
    def bent(self, *, degrees: float | None = None, radians: float | None = None) -> Shape: ...
    def twisted(self, *, degrees: float | None = None, radians: float | None = None) -> Shape: ...
    def extruded(self, height: float) -> Shape: ...
    def revolved(self) -> Shape: ...
    def mass(
        self,
        density: float = 1000.0,
        *,
        tolerance: float | None = None,
        cells: int | None = None,
    ) -> Mass: ...
    def mesh(
        self,
        *,
        cell: float | None = None,
        tolerance: float | None = None,
        most_triangles: int | None = None,
    ) -> Mesh: ...
    def baked(
        self,
        *,
        tolerance: float | None = None,
        cell: float | None = None,
        kernel: Literal["quadratic", "trilinear"] = "quadratic",
        store: Literal["f32", "i16", "i8"] = "f32",
        band: float | None = None,
        most_nodes: int | None = None,
        threads: int = 1,
    ) -> Shape: ...
    def figure(
        self, *, plane: Plane = "xy", at: float = 0.0, title: str | None = None
    ) -> Figure: ...
    def render(
        self,
        *,
        width: int = 640,
        height: int = 480,
        yaw: float = 35.0,
        pitch: float = 25.0,
        threads: int = 1,
    ) -> Image: ...
    def plot(self, *, plane: Plane = "xy", at: float = 0.0, ax: Any = None) -> Any: ...
    def sample(
        self, spacing: float, *, margin: float | None = None, threads: int = 1
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float]: ...
    def _repr_svg_(self) -> str: ...
    def _repr_png_(self) -> bytes: ...

@final
class Figure:
    def to_svg(self) -> str: ...
    def to_png(self, *, width: int = 1200) -> bytes: ...
    def save(self, file: str | PathLike[str], *, width: int = 1200) -> None: ...
    def _repr_svg_(self) -> str: ...
    def _repr_png_(self) -> bytes: ...

@final
class Image:
    @property
    def pixels(self) -> NDArray[np.uint8]: ...
    def to_png(self) -> bytes: ...
    def save(self, file: str | PathLike[str]) -> None: ...
    def _repr_png_(self) -> bytes: ...

@final
class Mesh:
    def __new__(cls, vertices: Any, faces: ArrayLike | None = None) -> Mesh: ...
    @staticmethod
    def load(file: str | PathLike[str], *, scale: float = 1.0) -> Mesh: ...
    @staticmethod
    def of_volume(
        samples: ArrayLike,
        value: float,
        *,
        spacing: float | Sequence[float],
        origin: ArrayLike | None = None,
        inside: Literal["above", "below"] = "above",
    ) -> Mesh: ...
    def save(self, file: str | PathLike[str]) -> None: ...
    @property
    def dimension(self) -> int: ...
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def is_watertight(self) -> bool: ...
    def report(self) -> MeshReport: ...
    def shape(self, *, thickness: float | None = None, weld_within: float | None = None) -> Shape: ...
    def findings(self) -> str: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class Scene:
    def __new__(
        cls,
        bodies: Shape | dict[str, Shape],
        *,
        poses: dict[str, Any] | None = None,
        materials: Mapping[str, Any] | None = None,
        tool: Mapping[str, Any] | None = None,
        guides: Sequence[Mapping[str, Any]] | None = None,
        motions: Sequence[Mapping[str, Any]] | None = None,
    ) -> Scene: ...
    @staticmethod
    def load(
        file: str | PathLike[str], *, largest_file: int | None = None
    ) -> Scene: ...
    @staticmethod
    def from_json(text: str, *, folder: str | PathLike[str] | None = None) -> Scene: ...
    def ask(self, question: Mapping[str, Any] | str) -> dict[str, Any]: ...
    def to_json(self) -> str: ...
    def save(self, file: str | PathLike[str]) -> None: ...
    @property
    def dimension(self) -> int: ...
    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def whole(self) -> Shape: ...
    def __getitem__(self, name: str, /) -> Body: ...
    def __contains__(self, name: object, /) -> bool: ...
    def __iter__(self) -> Iterator[str]: ...
    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...

@final
class Mailbox:
    def __new__(
        cls, profile: str = "omega", *, points: int = 1, rate: float | None = None, dimension: int = 3
    ) -> Mailbox: ...
    def set(self, positions: ArrayLike, *, time: float | None = None) -> None: ...
    @property
    def forces(self) -> NDArray[np.float64]: ...
    @property
    def rate(self) -> float | None: ...
    @property
    def ticks(self) -> int: ...
    def lose(self) -> None: ...

@final
class Servo:
    def __new__(
        cls,
        scene: Scene | Shape | dict[str, Shape],
        *,
        device: str | Mailbox | None = None,
        hand: ArrayLike | None = None,
        points: int = 1,
        duration: float | None = None,
        record: float | None = None,
        rate: float | None = None,
    ) -> Servo: ...
    def __enter__(self) -> Servo: ...
    def __exit__(self, *_exception: object) -> None: ...
    def end(self) -> None: ...
    @property
    def has_ended(self) -> bool: ...
    def latest(self) -> Snapshot | None: ...
    def take_events(self) -> list[Event]: ...
    def events(self) -> Iterator[Event]: ...
    def wait(self, timeout: float | None = None) -> bool: ...
    def set_poses(self, poses: dict[str, Any], over: float = 0.0) -> None: ...
    def limit_force(self, newtons: float) -> None: ...
    def stop(self) -> None: ...
    def release(self) -> None: ...
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def trace(self) -> Trace: ...

@final
class Track:
    def __new__(cls, a: Shape, b: Shape) -> Track: ...
    def separation(
        self,
        *,
        a: ArrayLike | None = None,
        b: ArrayLike | None = None,
        tolerance: float | None = None,
        budget: int | None = None,
    ) -> Separation: ...
    def manifold(
        self,
        *,
        a: ArrayLike | None = None,
        b: ArrayLike | None = None,
        margin: float | None = None,
        spacing: float | None = None,
        most: int | None = None,
        tolerance: float | None = None,
        budget: int | None = None,
    ) -> Manifold: ...
    def forget(self) -> None: ...

@final
class World:
    def __new__(
        cls, scene: Scene | Shape | dict[str, Shape], *, margin: float | None = None
    ) -> World: ...
    def set_poses(self, poses: dict[str, Any]) -> None: ...
    def pose(self, name: str) -> NDArray[np.float64]: ...
    def step(self, *, threads: int = 1) -> list[Neighbours]: ...
    def first_impacts(
        self, ends: dict[str, Any], *, gap: float | None = None, budget: int | None = None
    ) -> list[BodyImpact]: ...

def sweep(
    a: Shape,
    b: Shape,
    *,
    start: ArrayLike | None = None,
    end: ArrayLike | None = None,
    a_start: ArrayLike | None = None,
    a_end: ArrayLike | None = None,
    gap: float | None = None,
    budget: int | None = None,
) -> FirstTouch: ...
def feel(
    scene: Scene | Shape | dict[str, Shape],
    *,
    device: str | None = None,
    hand: ArrayLike | None = None,
    points: int = 1,
    duration: float = 10.0,
    rate: float = 1000.0,
) -> Felt: ...
def device_profiles() -> dict[str, dict[str, Any]]: ...
def union(*shapes: Shape | Iterable[Shape]) -> Shape: ...
def intersection(*shapes: Shape | Iterable[Shape]) -> Shape: ...
def difference(*shapes: Shape | Iterable[Shape]) -> Shape: ...
def symmetric_difference(*shapes: Shape | Iterable[Shape]) -> Shape: ...
def smooth_union(
    *shapes: Shape | Iterable[Shape], width: float, profile: Profile = "quadratic"
) -> Shape: ...
def smooth_intersection(
    *shapes: Shape | Iterable[Shape], width: float, profile: Profile = "quadratic"
) -> Shape: ...
def smooth_difference(
    *shapes: Shape | Iterable[Shape], width: float, profile: Profile = "quadratic"
) -> Shape: ...
def separation(
    a: Shape, b: Shape, *, tolerance: float | None = None, budget: int | None = None
) -> Separation: ...
def penetration(
    a: Shape, b: Shape, *, tolerance: float | None = None, budget: int | None = None
) -> PenetrationBounds: ...
def overlap(a: Shape, b: Shape, *, budget: int | None = None) -> Overlap: ...
def closest_points(
    a: Shape, b: Shape, *, tolerance: float | None = None, budget: int | None = None
) -> ClosestPoints: ...
def manifold(
    a: Shape,
    b: Shape,
    *,
    margin: float | None = None,
    spacing: float | None = None,
    most: int | None = None,
    tolerance: float | None = None,
    budget: int | None = None,
) -> Manifold: ...
def cast_ray(
    shape: Shape,
    origin: ArrayLike,
    direction: ArrayLike,
    length: float = 1000.0,
    *,
    tolerance: float | None = None,
    budget: int | None = None,
) -> RayCast: ...
def cast_rays(
    shape: Shape,
    origins: ArrayLike,
    directions: ArrayLike,
    length: float = 1000.0,
    *,
    tolerance: float | None = None,
    budget: int | None = None,
    threads: int = 1,
) -> RayHits: ...
def separations(
    a: Shape,
    b: Shape,
    poses: ArrayLike,
    *,
    tolerance: float | None = None,
    budget: int | None = None,
    threads: int = 1,
) -> Separations: ...
def overlaps(
    a: Shape, b: Shape, poses: ArrayLike, *, budget: int | None = None, threads: int = 1
) -> NDArray[np.int8]: ...
def mesh_contacts(
    shape: Shape,
    mesh: Mesh | Any,
    *,
    pose: ArrayLike | None = None,
    gap: float = 0.0,
    tolerance: float | None = None,
    budget: int | None = None,
) -> MeshContacts: ...
def mesh_hits(
    shape: Shape,
    mesh: Mesh | Any,
    *,
    pose: ArrayLike | None = None,
    gap: float = 0.0,
    tolerance: float | None = None,
    budget: int | None = None,
) -> MeshHits: ...
def from_function(
    function: Callable[[NDArray[np.float64]], ArrayLike],
    *,
    lipschitz: float,
    bounds: ArrayLike | None = None,
    dimension: int = 3,
) -> Shape: ...
def from_samples(
    samples: ArrayLike,
    *,
    cell: float,
    origin: ArrayLike | None = None,
    kernel: Literal["quadratic", "trilinear"] = "quadratic",
) -> Shape: ...
def primitive(name: str, dimension: int, values: Sequence[Any]) -> Shape: ...
def catalogue() -> list[dict[str, Any]]: ...
def main(arguments: Sequence[str]) -> int: ...
