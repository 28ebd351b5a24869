# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Shapes: made, written, typed and pickled, with the same bits."""

from __future__ import annotations

import copy
import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import palpate as pp
import pytest
from palpate import _palpate

NAMES = vars(pp)
CATALOGUE = _palpate.catalogue()


def primitive(entry: dict[str, Any]) -> pp.Shape:
    """The example of a primitive, by its constructor."""
    return eval(entry["made"], NAMES)


BALL, BOX = pp.ball(0.5), pp.cuboid([1.0, 0.6, 0.8])
DISC = pp.ball(0.3, dimension=2).translated([0.5, 0.1])
OPERATED = {
    "union": BALL | BOX,
    "intersection": BALL & BOX,
    "difference": BALL - BOX - BOX.translated([1, 0, 0]),
    "symmetric_difference": BALL ^ BOX,
    "smooth_union": BALL.smooth_union(BOX, width=0.01, profile="circular_geometrical"),
    "smooth_intersection": BALL.smooth_intersection(BOX, width=0.01, profile="root"),
    "smooth_difference": BALL.smooth_difference(BOX, width=0.01),
    "displaced": BALL.displaced(BOX, height=0.02),
    "morphed": BALL.morphed(BOX, progress=0.25),
    "translated": BALL.translated([1, 2, 3]),
    "rotated": BOX.rotated([1, 2, 3], degrees=30),
    "placed": BOX.placed([1, 2, 3, 0.5, 0.5, 0.5, 0.5]),
    "scaled": BOX.scaled(0.3),
    "stretched": BOX.stretched([1, 2, 3]),
    "offset": BOX.offset(0.1),
    "shell": BOX.shell(0.1),
    "elongated": BALL.elongated([0, 1, 0]),
    "mirrored": BOX.translated([1, 0, 0]).mirrored("x"),
    "repeated": BALL.repeated(x=2.0, z={"spacing": 3.0, "first": -1, "last": 2}),
    "bent": BOX.bent(radians=0.5),
    "twisted": BOX.twisted(degrees=30),
    "extruded": DISC.extruded(0.2),
    "revolved": DISC.revolved(),
    "in the plane": DISC.rotated(degrees=20).mirrored("y").repeated(y={"spacing": 2.0, "first": 0, "last": 1}).bent(degrees=3),
}
ALL = {f"{entry['name']} in {entry['dimension']}D": primitive(entry) for entry in CATALOGUE} | OPERATED


def points(shape: pp.Shape) -> np.ndarray:
    return np.random.default_rng(1).uniform(-2, 2, (300, shape.dimension))


@pytest.mark.parametrize("name", ALL)
def test_a_shape_comes_back_with_its_bits(name: str) -> None:
    shape = ALL[name]
    at = points(shape)
    for again in [
        eval(repr(shape), NAMES),
        pickle.loads(pickle.dumps(shape)),
        copy.deepcopy(shape),
        copy.copy(shape),
        pp.Shape.from_json(shape.to_json(), dimension=shape.dimension),
    ]:
        assert again == shape and hash(again) == hash(shape)
        assert again.dimension == shape.dimension
        assert np.array_equal(again.distance(at), shape.distance(at))
    other = BALL.scaled(7)
    assert shape != other and shape != "a shape"


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: f"{entry['name']}{entry['dimension']}")
def test_a_primitive_takes_its_parameters_by_name(entry: dict[str, Any]) -> None:
    shape = primitive(entry)
    assert shape.dimension == entry["dimension"]
    missing = [name for name, kind, _, _ in entry["parameters"] if kind != "Angle"]
    if missing:
        with pytest.raises(TypeError):
            getattr(pp, entry["name"])()


def test_the_constructors_are_those_of_the_catalogue() -> None:
    sys.path.insert(0, str(Path(__file__).parents[1]))
    try:
        import generate
    finally:
        sys.path.pop(0)
    assert generate.PLACE.read_text(encoding="utf-8") == generate.text(), "run: cargo xtask renew"


def test_operators_are_their_methods_and_functions() -> None:
    a, b = BALL, BOX
    for operator, method, function in [
        (a | b, a.union(b), pp.union(a, b)),
        (a & b, a.intersection(b), pp.intersection([a, b])),
        (a - b, a.difference([b]), pp.difference(a, [b])),
        (a ^ b, a.symmetric_difference(b), pp.symmetric_difference(a, b)),
    ]:
        assert operator == method == function
    assert pp.smooth_union(a, b, width=0.1) == a.smooth_union(b, width=0.1)


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: pp.ball(-0.5), pp.ShapeError, "radius must be positive, got -0.5 m"),
        (lambda: pp.ball("a"), TypeError, "radius must be a number, got 'a'"),
        (lambda: pp.ball(0.5, dimension=4), ValueError, "dimension must be 2 or 3, got 4"),
        (lambda: pp.cuboid([1, 2, 3, 4]), ValueError, "3 in space, got the shape (4,)"),
        (lambda: pp.cuboid(3), ValueError, "3 in space, got the shape ()"),
        (lambda: pp.pie(radius=1), TypeError, "exactly one of angle= [rad] and angle_degrees= must be given"),
        (lambda: BALL | DISC, ValueError, "both shapes must have the same dimension, got 3D and 2D"),
        (lambda: BALL | 3, TypeError, "unsupported operand"),
        (lambda: pp.union(), ValueError, "at least one shape is needed"),
        (lambda: pp.union(BALL, 3), TypeError, "shapes must be of the class Shape, got int"),
        (lambda: BALL.rotated(degrees=3), TypeError, "in 3D a turn is an axis"),
        (lambda: BALL.rotated([0, 0, 1]), TypeError, "one of degrees= and radians="),
        (lambda: BALL.rotated([0, 0, 1], degrees=1, radians=1), TypeError, "one of degrees= and radians="),
        (lambda: DISC.rotated([0, 0, 1], degrees=1), TypeError, "in 2D a turn is one of"),
        (lambda: BALL.rotated(matrix=np.ones((3, 3))), pp.ShapeError, "matrix"),
        (lambda: BALL.translated([1, 2]), ValueError, "offset must have the shape (3,), got (2,)"),
        (lambda: BALL.placed([1, 2]), ValueError, "pose must have the shape (3,), (7,) or (4, 4), got (2,)"),
        (lambda: BALL.mirrored("w"), ValueError, "the axis must be one of x, y, z in 3D, got \"w\""),
        (lambda: DISC.mirrored("z"), ValueError, "the axis must be one of x, y in 2D"),
        (lambda: DISC.repeated(z=1.0), TypeError, "there is no z in 2D"),
        (lambda: BALL.repeated(x={"spacing": 1.0, "count": 3}), TypeError, "not count"),
        (lambda: BALL.extruded(1.0), TypeError, "extruded needs a shape in 2D, got one in 3D"),
        (lambda: DISC.twisted(degrees=3), TypeError, "twisted needs a shape in 3D, got one in 2D"),
        (lambda: BALL.smooth_union(BOX, width=0.1, profile="round"), ValueError, "profile must be one of quadratic"),
        (lambda: pp.Shape.from_json("{"), pp.SceneError, "line 1"),
    ],
)
def test_what_makes_no_shape_is_refused(make: Any, error: type, words: str) -> None:
    with pytest.raises(error) as caught:
        make()
    assert words in str(caught.value)


def test_errors_say_what_they_know_and_can_be_pickled() -> None:
    with pytest.raises(pp.ShapeError) as caught:
        pp.ball(-0.5)
    for error in [caught.value, pickle.loads(pickle.dumps(caught.value))]:
        assert (error.parameter, error.value, error.unit) == ("radius", -0.5, "m")
        assert isinstance(error, pp.Error) and isinstance(error, ValueError)


def test_holes_are_cut_in_a_loop() -> None:
    plate = pp.cuboid([1, 0.1, 1])
    for i in range(1000):
        plate -= pp.cylinder(0.01, 1).translated([0.001 * i, 0, 0])
    assert plate.distance([0, 0, 0]) > 0
    balls = pp.ball(0.1)
    for i in range(10_000):
        balls |= pp.ball(0.1).translated([i, 0, 0])
    assert balls.distance([9999, 0, 0]) == -0.1


def test_python_and_the_program_have_the_same_bits(tmp_path: Path) -> None:
    shape = OPERATED["smooth_union"].rotated([1, 2, 3], degrees=20)
    scene = {"palpate": 1, "dimension": 3, "bodies": [{"name": "b", "shape": json.loads(shape.to_json())}]}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene), encoding="utf-8")
    at = [0.3, 0.4, 0.123]
    command = [sys.executable, "-m", "palpate", "eval", str(file), "--at", ",".join(map(str, at)), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["distance"] == shape.distance(at)


def test_shapes_that_are_equal_have_equal_hashes() -> None:
    # That of the text has the sign of zero.
    one, two = pp.ball(0.5).translated([-0.0, 1, 0]), pp.ball(0.5).translated([0.0, 1, 0])
    assert one == two and hash(one) == hash(two) and len({one, two}) == 1
