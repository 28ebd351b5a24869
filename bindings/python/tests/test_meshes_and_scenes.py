# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Meshes from arrays, files and trimesh; scenes from shapes and files; mass."""

from __future__ import annotations

import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import palpate as pp
import pytest
import trimesh

BOX = pp.cuboid([0.3, 0.2, 0.1])
MESH = BOX.mesh(cell=0.017)


def test_a_mesh_goes_through_trimesh_and_back() -> None:
    theirs = trimesh.Trimesh(MESH.vertices, MESH.faces)
    assert theirs.is_watertight and abs(theirs.volume - 0.006) < 1e-9
    again = pp.Mesh(theirs)
    assert again.report().enclosed == pytest.approx(0.006)
    solid = pp.Mesh(trimesh.creation.box([0.3, 0.2, 0.1])).shape()
    points = np.random.default_rng(5).uniform(-0.3, 0.3, (500, 3))
    assert np.abs(solid.distance(points) - BOX.distance(points)).max() < 1e-12


@pytest.mark.parametrize("ending", ["obj", "stl", "ply", "glb"])
def test_files_hold_the_mesh(tmp_path: Path, ending: str) -> None:
    file = tmp_path / f"part.{ending}"
    MESH.save(file)
    assert pp.Mesh.load(file).is_watertight
    assert pp.Mesh.load(file, scale=1000).report().enclosed == pytest.approx(6e6, rel=1e-5)
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


def test_a_tolerance_chooses_the_cells() -> None:
    ball = pp.ball(0.5)
    for tolerance in [1e-2, 1e-3]:
        mesh = ball.mesh(tolerance=tolerance)
        assert mesh.is_watertight
        middles = mesh.vertices[mesh.faces].mean(axis=1)
        assert np.abs(ball.distance(middles)).max() <= tolerance
        assert np.abs(ball.distance(mesh.vertices)).max() <= tolerance


def test_hits_are_those_of_contacts_and_a_pose_moves_the_mesh() -> None:
    ball, moved = pp.ball(0.1), MESH.vertices + [0, 0.195, 0]
    here = pp.mesh_contacts(ball, pp.Mesh(moved, MESH.faces))
    there = pp.mesh_contacts(ball, MESH, pose=[0, 0.195, 0])
    assert set(here.hits) == set(there.hits) and len(there.hits) > 0
    assert there.contacts.gap.min() == pytest.approx(-0.005, abs=1e-4)
    assert set(pp.mesh_hits(ball, MESH, pose=[0, 0.195, 0]).hits) == set(there.hits)
    assert len(pp.mesh_hits(ball, MESH, pose=[0, 0.25, 0])) == 0
    assert len(pp.mesh_hits(ball, MESH, pose=[0, 0.25, 0], gap=0.06)) > 0


@pytest.mark.parametrize(
    "how",
    [
        {"tolerance": 2e-3},
        {"cell": 0.005, "kernel": "trilinear", "store": "i16"},
        {"cell": 0.004, "band": 8.0},
    ],
)
def test_a_shape_sampled_on_a_grid_is_a_shape(how: dict[str, Any]) -> None:
    part = pp.cuboid([0.06, 0.04, 0.05]) - pp.ball(0.02)
    grid = part.baked(**how)
    value, within = grid.promise.deviation.value, grid.promise.deviation.within
    points = np.random.default_rng(7).uniform(-0.05, 0.05, (5000, 3))
    near = np.abs(part.distance(points)) < within
    assert near.any()
    off = np.abs(grid.distance(points) - part.distance(points))[near].max()
    assert off <= value and value <= how.get("tolerance", 1.0)
    # As other shapes: pickled, compared, typed, felt.
    assert pickle.loads(pickle.dumps(grid)) == grid and grid != part
    assert eval(repr(grid), vars(pp)) == grid and hash(eval(repr(grid), vars(pp))) == hash(grid)
    felt = pp.feel(grid, hand=[[0.0, 0.0, 0.05, 0.0], [0.3, 0.0, 0.015, 0.0]], duration=0.3)
    assert felt.trace.force[-1, 1] > 0


@pytest.mark.parametrize("dimension", [2, 3])
def test_an_array_of_samples_is_a_shape(dimension: int) -> None:
    # Axes of different lengths, so that none is taken for another.
    counts, cell, origin = [31, 41, 51][:dimension], 0.01, [-0.15, -0.2, -0.25][:dimension]
    truth = pp.cuboid([0.1, 0.15, 0.2][:dimension])
    sides = [o + cell * np.arange(n) for o, n in zip(origin, counts, strict=True)]
    nodes = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1)
    values = truth.distance(nodes)
    for given in [values, np.asfortranarray(values), values.astype(np.float32)]:
        shape = pp.from_samples(given, cell=cell, origin=origin, kernel="trilinear")
        inner = nodes[1:-1, 1:-1]
        assert np.abs(shape.distance(inner) - truth.distance(inner)).max() < 1e-7
    assert pickle.loads(pickle.dumps(shape)) == shape and "grid" in repr(shape)
    assert pp.overlap(shape, pp.ball(0.05, dimension=dimension)).overlaps
    down = [[0.0, *([0.0, 0.12, 0.0][:dimension])], [0.3, *([0.0, 0.07, 0.0][:dimension])]]
    assert pp.feel(shape, hand=down, duration=0.3).trace.force[-1, 1] > 0
    for wrong, words in [(values.ravel(), "samples must have the shape"), (-values, "border"), (values * np.nan, "")]:
        with pytest.raises(ValueError) as caught:
            pp.from_samples(wrong, cell=cell)
        assert words in str(caught.value)


def test_grids_are_of_functions_and_of_the_plane_too() -> None:
    half = [[-1.0, -1.0], [1.0, 1.0]]
    disc = pp.from_function(lambda p: np.linalg.norm(p, axis=1) - 0.5, lipschitz=1.0, bounds=half, dimension=2)
    grid = disc.baked(cell=0.05)
    assert grid.distance([0.7, 0.0]) == pytest.approx(0.2, abs=2e-3)
    assert pp.ball(0.5, dimension=2).baked(cell=0.05).distance([0.55, 0.0]) == pytest.approx(0.05, abs=2e-3)
    for wrong, error, words in [
        ({}, TypeError, "one of tolerance= and cell="),
        ({"cell": 0.1, "tolerance": 0.1}, TypeError, "one of tolerance= and cell="),
        ({"cell": -1.0}, pp.Error, "cell"),
        ({"cell": 0.1, "kernel": "cubic"}, ValueError, 'kernel must be one of "quadratic", "trilinear", got "cubic"'),
        ({"cell": 0.1, "store": "f64"}, ValueError, '"f32", "i16", "i8"'),
        ({"cell": 0.1, "band": 1.0}, pp.Error, "band"),
        ({"cell": 3.0}, pp.GridError, ""),
    ]:
        with pytest.raises(error) as caught:
            pp.ball(0.5).baked(**wrong)
        assert words in str(caught.value)
    with pytest.raises(pp.GridError, match="bounds"):
        pp.half_space([0, 1, 0], 0.0).baked(cell=0.1)


def test_a_mesh_can_be_pickled_and_compared() -> None:
    again = pickle.loads(pickle.dumps(MESH))
    assert again == MESH and again != pp.Mesh(MESH.vertices, MESH.faces[1:])
    assert len(MESH) == len(MESH.faces) and "watertight" in repr(MESH)


def test_an_outline_is_a_solid_of_the_plane() -> None:
    square = pp.Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    assert square.dimension == 2 and square.is_watertight
    assert square.shape().distance([0.5, 0.5]) == -0.5
    found = pp.mesh_contacts(pp.ball(0.1, dimension=2).translated([0.5, 1.05]), square)
    assert found.contacts.gap.min() == pytest.approx(-0.05, abs=1e-4)


def test_faces_that_bound_nothing_are_a_plate() -> None:
    sheet = pp.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    with pytest.raises(pp.MeshError):
        sheet.shape()
    assert sheet.shape(thickness=0.02).distance([0.5, 0.5, 1.0]) == pytest.approx(0.99)


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: pp.Mesh([[0, 0, 0]], [[0, 0, 1]]), pp.MeshError, ""),
        (lambda: pp.Mesh([[0, 0, 0]], [[0, 0, -1]]), ValueError, "faces[0, 2] must be the number of a vertex, from 0, got -1"),
        (lambda: pp.Mesh([[0, 0, 0]], [[0, 0.5, 0]]), ValueError, "faces[0, 1]"),
        (lambda: pp.Mesh([0, 0, 0], [[0, 1, 2]]), ValueError, "vertices must have the shape (n, 2) or (n, 3), got (3,)"),
        (lambda: pp.Mesh([[0, 0, 0]], [[0, 1]]), ValueError, "faces must have the shape (m, 3), got (1, 2)"),
        (lambda: pp.Mesh(3), TypeError, "vertices"),
        (lambda: pp.Mesh.load("no/such.stl"), pp.Error, "no/such.stl"),
        (lambda: MESH.save("part.doc"), ValueError, "must end in .obj, .stl, .ply or .glb"),
        (lambda: MESH.save("no/such/folder/part.stl"), OSError, ""),
        (lambda: BOX.mesh(cell=-1), pp.MeshError, "cell"),
        (lambda: BOX.mesh(tolerance=0), pp.MeshError, "tolerance"),
        (
            lambda: pp.ball(0.5).mesh(tolerance=1e-6, most_triangles=20_000),
            pp.MeshError,
            "more than the 20000 triangles allowed",
        ),
        (lambda: BOX.mesh(), TypeError, "one of cell= and tolerance="),
        (lambda: pp.mesh_hits(pp.ball(1, dimension=2), MESH), ValueError, "got 2D and 3D"),
        (lambda: pp.half_space([0, 1, 0], 0.0).mesh(cell=0.1), pp.MeshError, "bounds"),
        (lambda: pp.mesh_contacts(pp.ball(1, dimension=2), MESH), ValueError, "got 2D and 3D"),
    ],
)
def test_what_is_no_mesh_is_refused(make: Any, error: type, words: str) -> None:
    with pytest.raises(error) as caught:
        make()
    assert words in str(caught.value)


def test_mass_has_bounds() -> None:
    mass = (pp.ball(0.5) - pp.cylinder(0.1, 2.0)).mass(density=7800)
    drilled = 4 / 3 * math.pi * (0.5**2 - 0.1**2) ** 1.5
    assert abs(mass.volume - drilled) <= mass.volume_error <= 1e-3 * mass.volume
    assert mass.mass == 7800 * mass.volume and mass.second_moments.shape == (3, 3)
    with pytest.raises(pp.ShapeError):
        pp.half_space([0, 1, 0], 0.0).mass()


def test_a_scene_is_written_read_and_pickled(tmp_path: Path) -> None:
    scene = pp.Scene({"table": BOX, "ball": pp.ball(0.05).translated([0, 0.1, 0])})
    file = tmp_path / "scene.json"
    scene.save(file)
    for again in [pp.Scene.load(file), pickle.loads(pickle.dumps(scene)), pp.Scene.from_json(scene.to_json())]:
        assert again.names == ("table", "ball") and again["ball"].shape == scene["ball"].shape
    assert list(scene) == ["table", "ball"] and "ball" in scene and len(scene) == 2
    body = scene["ball"]
    assert body.shape_in_body.placed(body.pose) == body.shape or np.array_equal(body.pose, np.eye(4))
    with pytest.raises(KeyError, match="there are table, ball"):
        scene["bal"]


def test_a_scene_finds_the_files_beside_it(tmp_path: Path) -> None:
    MESH.save(tmp_path / "part.ply")
    text = """{ "palpate": 1, "dimension": 3,
      "bodies": [ { "name": "part", "shape": { "mesh": { "file": "part.ply" } } } ] }"""
    (tmp_path / "scene.json").write_text(text, encoding="utf-8")
    scene = pp.Scene.load(tmp_path / "scene.json")
    assert scene.whole.distance([0, 0.2, 0]) == pytest.approx(0.1)
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert pp.Scene.from_json(text, folder=tmp_path).whole.distance([0, 0.2, 0]) == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: pp.Scene({"a": BOX, "b": pp.ball(1, dimension=2)}), ValueError, "got 1 in 2D and 1 in 3D"),
        (lambda: pp.Scene(3), TypeError, "a dict of names and shapes"),
        (lambda: pp.Scene.load("no/such.json"), pp.Error, "no/such.json"),
        (lambda: pp.Scene.from_json('{ "palpate": 1, "dimension": 3, "bodys": [] }'), pp.SceneError, "bodys"),
    ],
)
def test_what_is_no_scene_is_refused(make: Any, error: type, words: str) -> None:
    with pytest.raises(error) as caught:
        make()
    assert words in str(caught.value)


def test_the_error_of_a_scene_has_its_place() -> None:
    with pytest.raises(pp.SceneError) as caught:
        pp.Scene.from_json('{ "palpate": 1, "dimension": 3,\n "bodies": [ { "name": "b", "shape": { "ball": { "radius": -1 } } } ] }')
    error = caught.value
    assert (error.line, error.path, error.value) == (2, "bodies[0].shape.ball.radius", -1)


def test_a_shape_of_a_mesh_is_pickled_compared_felt_and_sent_to_workers(tmp_path: Path) -> None:
    mesh = pp.cuboid([0.1, 0.1, 0.1]).mesh(cell=0.03)
    solid = mesh.shape()
    again = pickle.loads(pickle.dumps(solid))
    assert again == solid == mesh.shape() and hash(again) == hash(solid)
    assert again != pp.cuboid([0.1, 0.1, 0.1]).mesh(cell=0.02).shape()
    points = np.random.default_rng(7).uniform(-0.1, 0.1, (500, 3))
    assert np.array_equal(again.distance(points), solid.distance(points))
    cut = solid - pp.ball(0.02)
    hand = [[0, 0, 0.08, 0], [0.2, 0, 0.045, 0]]
    felt = pp.feel(pp.Scene({"part": cut}), hand=hand, duration=0.2)
    assert felt.trace.force[-1, 1] > 0
    heights = np.linspace(0, 0.5, 5)[:, None] * [0, 1, 0]
    run = pp.batch.overlaps(tmp_path / "run", solid, pp.ball(0.05), heights)
    assert run.table().column("overlaps").to_pylist() == [1, 0, 0, 0, 0]
    assert "faces" in repr(solid)


def test_contacts_take_a_mesh_of_another_library() -> None:
    theirs = trimesh.Trimesh(MESH.vertices, MESH.faces)
    ball = pp.ball(0.05).translated([0, 0.14, 0])
    ours, found = (pp.mesh_contacts(ball, mesh) for mesh in (MESH, theirs))
    assert np.array_equal(ours.contacts.gap, found.contacts.gap) and len(found) > 0
    with pytest.raises(TypeError, match="a mesh has vertices and faces, got a int"):
        pp.mesh_contacts(ball, 3)


def test_a_picture_of_a_shape_without_bounds_is_refused() -> None:
    with pytest.raises(ValueError, match="no bounds: intersect it with a box"):
        pp.half_space([0, 1, 0], 0.0).render(width=32, height=24)


def test_the_surface_in_a_volume() -> None:
    # A box of samples of a length of its own along each axis, not in the middle: axes may not be mixed up.
    samples = np.zeros((8, 10, 12), np.float32)
    samples[2:5, 3:7, 4:9] = 1000
    mesh = pp.Mesh.of_volume(samples, 500, spacing=[0.001, 0.002, 0.003], origin=[1, 0, 0])
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    assert np.allclose(low, [1.0015, 0.005, 0.0105], atol=1e-6) and np.allclose(high, [1.0045, 0.013, 0.0255], atol=1e-6)
    assert mesh.is_watertight and mesh.shape().distance([1.003, 0.009, 0.018]) < 0
    below = pp.Mesh.of_volume(-samples, -500, spacing=0.001, inside="below")
    above = pp.Mesh.of_volume(samples, 500, spacing=0.001)
    assert np.array_equal(below.vertices, above.vertices) and np.array_equal(below.faces, above.faces)
    for wrong, error in [
        (lambda: pp.Mesh.of_volume(samples, 5000, spacing=1), pp.GridError),
        (lambda: pp.Mesh.of_volume(samples, 500, spacing=0), ValueError),
        (lambda: pp.Mesh.of_volume(samples, 500, spacing=-1), ValueError),
        (lambda: pp.Mesh.of_volume(np.full((3, 3, 3), np.nan), 500, spacing=1), pp.GridError),
        (lambda: pp.Mesh.of_volume(samples[:1], 500, spacing=1), pp.GridError),
        (lambda: pp.Mesh.of_volume(samples[0], 500, spacing=1), ValueError),
        (lambda: pp.Mesh.of_volume(samples, 500, spacing=[1, 2]), ValueError),
    ]:
        with pytest.raises(error):
            wrong()


def test_a_file_that_is_missing_is_a_missing_file(tmp_path: Path) -> None:
    file = tmp_path / "folder" / "it.json"
    for read in (pp.Scene.load, pp.Mesh.load):
        with pytest.raises(FileNotFoundError, match="it.") as caught:
            read(file if read is pp.Scene.load else file.with_suffix(".stl"))
        assert isinstance(caught.value, pp.MissingFileError)
    # The name of the file beside it, which is written first, helps nobody.
    with pytest.raises(FileNotFoundError) as unsaved:
        pp.Scene(pp.ball(0.1)).save(file)
    assert unsaved.value.filename == str(file)


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    file = tmp_path / "scene.json"
    pp.Scene(pp.ball(0.1)).save(file)
    size = file.stat().st_size
    assert pp.Scene.load(file, largest_file=size).names == ("body",)
    with pytest.raises(pp.FileError, match=f"longer than {size - 1} bytes, .*; largest_file raises that"):
        pp.Scene.load(file, largest_file=size - 1)
    # It was read until the memory was full.
    if Path("/dev/zero").exists():
        with pytest.raises(pp.FileError, match="longer than 268435456 bytes"):
            pp.Scene.load("/dev/zero")


def test_a_scene_is_read_by_a_bare_name_and_equals_its_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # The folder of a bare name is an empty path, which was refused; and folders were compared.
    monkeypatch.chdir(tmp_path)
    scene = pp.Scene(pp.ball(0.05))
    scene.save("scene.json")
    assert pp.Scene.load("scene.json") == scene
    assert pp.Scene.from_json(scene.to_json(), folder="") == scene


def test_what_is_replaced_keeps_its_mode_and_its_link(tmp_path: Path) -> None:
    mesh = pp.ball(0.5).mesh(cell=0.2)
    file, link = tmp_path / "it.stl", tmp_path / "link.stl"
    mesh.save(file)
    file.chmod(0o600)
    link.symlink_to(file)
    size = file.stat().st_size
    pp.ball(0.5).mesh(cell=0.1).save(link)
    assert link.is_symlink() and file.stat().st_size > size and file.stat().st_mode & 0o777 == 0o600


def test_a_grid_of_many_nodes_is_pickled() -> None:
    # Grids could have twice as many nodes as those that scenes bake.
    with pytest.raises(pp.GridError, match="more than the 33554432 allowed"):
        pp.ball(0.5).baked(cell=0.003)
    small = pp.ball(0.5).baked(cell=0.1, most_nodes=10_000)
    assert "most_nodes=10000" in repr(small) and eval(repr(small), vars(pp)) == small
    with pytest.raises(ValueError, match="most_nodes must be at most"):
        pp.ball(0.5).baked(cell=1e-6, most_nodes=2**63)


def test_samples_of_another_shape_are_told_as_they_are() -> None:
    with pytest.raises(ValueError, match=r"got \(2, 3, 4, 5\)"):
        pp.from_samples(np.ones((2, 3, 4, 5)), cell=1)
