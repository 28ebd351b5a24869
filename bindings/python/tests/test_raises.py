# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What docstrings say that is raised, is raised."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import palpate as pp
import pytest

BALL, DISC, GROUND = pp.ball(0.5), pp.circle(0.5), pp.half_space([0, 1, 0], 0.0)
SHEET = pp.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
NAN = float("nan")


def waves(lipschitz: float = 1.5) -> pp.Shape:
    return pp.from_function(lambda p: p[:, 1], lipschitz=lipschitz)


def world() -> pp.World:
    return pp.World({"a": BALL})


RAISED: list[tuple[Callable[[], Any], type[Exception]]] = [
    (lambda: pp.separation(GROUND, GROUND), pp.QueryError),
    (lambda: pp.separation(BALL, BALL, tolerance=-1), pp.QueryError),
    (lambda: pp.separation(BALL, DISC), ValueError),
    (lambda: pp.overlap(GROUND, GROUND), pp.QueryError),
    (lambda: pp.overlap(BALL, DISC), ValueError),
    (lambda: pp.closest_points(GROUND, GROUND), pp.QueryError),
    (lambda: pp.closest_points(BALL, BALL, tolerance=NAN), pp.QueryError),
    (lambda: pp.manifold(GROUND, GROUND), pp.QueryError),
    (lambda: pp.manifold(BALL, BALL, spacing=-1), pp.QueryError),
    (lambda: pp.manifold(BALL, BALL, tolerance=-1), pp.QueryError),
    (lambda: pp.cast_ray(BALL, [0, 2, 0], [0, 0, 0]), pp.QueryError),
    (lambda: pp.cast_ray(BALL, [0, 2, 0], [0, 1, 0], -1.0), pp.QueryError),
    (lambda: pp.cast_ray(BALL, [0, 2, 0], [0, 1, 0], tolerance=-1), pp.QueryError),
    (lambda: pp.separations(GROUND, GROUND, [[0, 0, 0]]), pp.QueryError),
    (lambda: pp.separations(BALL, BALL, [[0, NAN, 0]]), pp.QueryError),
    (lambda: pp.separations(BALL, BALL, [[0, 0]]), ValueError),
    (lambda: pp.overlaps(GROUND, GROUND, [[0, 0, 0]]), pp.QueryError),
    (lambda: pp.overlaps(BALL, BALL, [[0, NAN, 0]]), pp.QueryError),
    (lambda: waves(0.0), ValueError),
    (lambda: pp.from_function(lambda p: 1 / 0, lipschitz=1).distance([[0, 0, 0]]), ZeroDivisionError),
    (lambda: GROUND.baked(cell=0.1), pp.GridError),
    (lambda: BALL.baked(cell=1e-9), pp.GridError),
    (lambda: BALL.baked(), TypeError),
    (lambda: pp.from_samples(np.full((3, 3), -1.0), cell=1), pp.GridError),
    (lambda: pp.from_samples(np.full((3, 3), NAN), cell=1), pp.GridError),
    (lambda: pp.from_samples(np.ones(3), cell=1), ValueError),
    (lambda: pp.Mailbox().set([[[0, 0, 0]]]), ValueError),
    (lambda: GROUND.mass(), pp.ShapeError),
    (lambda: BALL.mass(-1), pp.ShapeError),
    (lambda: BALL.mass(tolerance=0), pp.ShapeError),
    (lambda: GROUND.mesh(cell=0.1), pp.MeshError),
    (lambda: BALL.mesh(), TypeError),
    (lambda: SHEET.shape(), pp.MeshError),
    (lambda: SHEET.findings(), pp.MeshError),
    (lambda: SHEET.save("it.txt"), ValueError),
    (lambda: SHEET.save("/no such folder/it.stl"), OSError),
    (lambda: pp.mesh_contacts(BALL, SHEET, gap=-1), pp.QueryError),
    (lambda: pp.mesh_contacts(BALL, SHEET, tolerance=-1), pp.QueryError),
    (lambda: pp.mesh_contacts(DISC, SHEET), ValueError),
    (lambda: pp.mesh_hits(BALL, SHEET, gap=-1), pp.QueryError),
    (lambda: pp.mesh_hits(DISC, SHEET), ValueError),
    (lambda: BALL.figure(plane="xw"), ValueError),  # type: ignore[arg-type]
    (lambda: BALL.figure(at=NAN), pp.PlotError),
    (lambda: GROUND.render(), ValueError),
    (lambda: BALL.render(width=0), pp.PlotError),
    (lambda: DISC.render(), TypeError),
    (lambda: pp.Scene.load("no such file"), pp.MissingFileError),
    (lambda: pp.Mesh.load("no such file.stl"), pp.MissingFileError),
    (lambda: pp.Scene.from_json("{"), pp.SceneError),
    (lambda: pp.Shape.from_json('{ "ball": {} }', dimension=3), pp.SceneError),
    (lambda: waves().to_json(), pp.SceneError),
    (lambda: pp.Scene(BALL).save("/no such folder/it.json"), OSError),
    (lambda: pp.feel(waves(), hand=[0, 1, 0], duration=0.1), pp.SceneError),
    (lambda: pp.feel(BALL, hand=[0, NAN, 0], duration=0.1), pp.DeviceError),
    (lambda: pp.feel(BALL, hand=[0, 1, 0], duration=1e9), ValueError),
    (lambda: BALL.distance([0, 0]), ValueError),
    (lambda: BALL.distance("x"), TypeError),  # type: ignore[call-overload]
    (lambda: BALL.displaced(BALL, height=NAN), pp.ShapeError),
    (lambda: BALL.morphed(BALL, progress=2), pp.ShapeError),
    (lambda: BALL.translated([0, NAN, 0]), pp.ShapeError),
    (lambda: BALL.translated([0, 0]), ValueError),
    (lambda: BALL.rotated([0, 0, 0], degrees=1), pp.ShapeError),
    (lambda: BALL.rotated([0, 0, 1], degrees=NAN), pp.ShapeError),
    (lambda: BALL.rotated([0, 0, 1]), TypeError),
    (lambda: BALL.scaled(0), pp.ShapeError),
    (lambda: BALL.scaled([1, 2, 1]), TypeError),  # type: ignore[arg-type]
    (lambda: BALL.stretched([1, 0, 1]), pp.ShapeError),
    (lambda: BALL.shell(thickness=0), pp.ShapeError),
    (lambda: BALL.elongated([0, -1, 0]), pp.ShapeError),
    (lambda: DISC.extruded(height=0), pp.ShapeError),
    (lambda: BALL.extruded(height=1), TypeError),
    (lambda: BALL.revolved(), TypeError),
    (lambda: BALL.twisted(degrees=NAN), pp.ShapeError),
    (lambda: GROUND.twisted(degrees=90), pp.ShapeError),
    (lambda: DISC.twisted(degrees=90), TypeError),
    (lambda: BALL.union(DISC), ValueError),
    (lambda: pp.union(BALL, 3), TypeError),  # type: ignore[arg-type]
    (lambda: BALL.smooth_union(BALL, width=0), pp.ShapeError),
    (lambda: BALL.smooth_difference(BALL, width=0.1, profile="x"), ValueError),  # type: ignore[arg-type]
    (lambda: pp.smooth_intersection(BALL, DISC, width=0.1), ValueError),
    (lambda: BALL.placed([0, 0]), ValueError),
    (lambda: BALL.placed([0, NAN, 0]), pp.ShapeError),
    (lambda: BALL.placed([0] * 7), pp.ShapeError),
    (lambda: BALL.offset(NAN), pp.ShapeError),
    (lambda: DISC.mirrored("z"), ValueError),
    (lambda: BALL.repeated(x=0.1), pp.ShapeError),
    (lambda: DISC.repeated(z=1), TypeError),
    (lambda: BALL.bent(degrees=NAN), pp.ShapeError),
    (lambda: GROUND.bent(degrees=9), pp.ShapeError),
    (lambda: BALL.bent(), TypeError),
    (lambda: BALL.at([0, NAN, 0]), pp.QueryError),
    (lambda: BALL.at([0, 0]), ValueError),
    (lambda: pp.Scene(waves()), pp.SceneError),
    (lambda: pp.Scene(BALL, materials={"x": "rubber"}), KeyError),
    (lambda: pp.Scene({"a": BALL, "b": DISC}), ValueError),
    (lambda: pp.Mailbox("x"), pp.UnknownNameError),
    (lambda: pp.Mailbox(points=0), ValueError),
    (lambda: pp.Mailbox(points=2).set([[0, 0, 0]]), pp.DeviceError),
    (lambda: pp.Servo(BALL, device="x"), pp.UnknownNameError),
    (lambda: pp.Servo(BALL, hand=[0, 0.1, 0], rate=1e-9), pp.HapticsError),
    (lambda: pp.plot_contacts(pp.manifold(BALL, BALL), plane="xw"), ValueError),
    (lambda: pp.sweep(GROUND, GROUND, end=[0, 1, 0]), pp.QueryError),
    (lambda: pp.sweep(BALL, BALL, end=[0, 1, 0], gap=-1), pp.QueryError),
    (lambda: pp.sweep(BALL, BALL, end=[0, NAN, 0]), pp.ShapeError),
    (lambda: world().set_poses({"b": [0, 0, 0]}), KeyError),
    (lambda: world().set_poses({"a": [0, NAN, 0]}), pp.QueryError),
    (lambda: world().first_impacts({"b": [0, 0, 0]}), KeyError),
    (lambda: world().first_impacts({}, gap=-1), pp.QueryError),
    (lambda: world().pose("b"), KeyError),
    (lambda: pp.Track(GROUND, GROUND).separation(), pp.QueryError),
    (lambda: pp.Track(BALL, BALL).separation(a=[NAN, 0, 0]), pp.QueryError),
    (lambda: pp.Track(GROUND, GROUND).manifold(), pp.QueryError),
]


@pytest.mark.parametrize(("call", "error"), RAISED)
def test_what_a_docstring_says_is_raised(call: Callable[[], Any], error: type[Exception], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error) as caught:
        call()
    assert str(caught.value)


def test_what_a_servo_raises() -> None:
    with pp.Servo(pp.Scene(BALL), hand=[0, 1, 0]) as servo:
        with pytest.raises(KeyError):
            servo.set_poses({"none": [0, 0, 0]})
        with pytest.raises(ValueError):
            servo.set_poses({"body": [0, 0]})
