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


def test_a_mesh_can_be_pickled_and_compared() -> None:
    again = pickle.loads(pickle.dumps(MESH))
    assert again == MESH and again != pp.Mesh(MESH.vertices, MESH.faces[1:])
    assert len(MESH) == len(MESH.faces) and "watertight" in repr(MESH)


def test_an_outline_is_a_solid_of_the_plane() -> None:
    square = pp.Mesh([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1], [1, 2], [2, 3], [3, 0]])
    assert square.dimension == 2 and square.is_watertight
    assert square.shape().distance([0.5, 0.5]) == -0.5
    found = pp.mesh_contacts(pp.ball(0.1, dimension=2).translated([0.5, 1.05]), square)
    assert found.gaps.min() == pytest.approx(-0.05, abs=1e-4)


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
        (lambda: pp.Scene({"a": BOX, "b": pp.ball(1, dimension=2)}), ValueError, "got 1 bodies of 2D and 1 of 3D"),
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
    assert np.array_equal(ours.gaps, found.gaps) and len(found) > 0
    with pytest.raises(TypeError, match="a mesh has vertices and faces, got a int"):
        pp.mesh_contacts(ball, 3)


def test_a_picture_of_a_shape_without_bounds_is_refused() -> None:
    with pytest.raises(ValueError, match="no bounds: intersect it with a box"):
        pp.half_space([0, 1, 0], 0.0).render(width=32, height=24)
