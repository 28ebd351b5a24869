# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Questions: known answers lie between the bounds, and what cannot be asked is refused."""

from __future__ import annotations

import math
import pickle
import threading
from typing import Any

import numpy as np
import palpate as pp
import pytest

BALL = pp.ball(0.5)
PLATE = pp.cuboid([0.6, 0.4, 0.6]) - pp.cylinder(radius=0.1005, height=1.0)
PEG = pp.cylinder(radius=0.1, height=0.6)


def test_a_scene_answers_questions_by_the_keys_of_the_program() -> None:
    scene = pp.Scene({"left": pp.ball(0.5), "right": pp.ball(0.5).translated([2, 0, 0])})
    answer = scene.ask({"question": "point", "at": np.array([0.0, 2.0, 0.0]), "body": "left"})
    assert (answer["palpate"], answer["answer"], answer["distance"]) == (2, "point", 1.5)
    assert scene.ask('{"question": "mass"}')["bodies"][0]["name"] == "left"
    with pytest.raises(KeyError, match="lefd"):
        scene.ask({"question": "point", "at": [0, 0, 0], "body": "lefd"})
    with pytest.raises(ValueError, match="unknown field `margin_m`"):
        scene.ask({"question": "contacts", "margin_m": 1})


def test_known_separations_lie_between_the_bounds() -> None:
    for gap in [-0.3, -1e-3, 1e-3, 0.5]:
        other = BALL.translated([1 + gap, 0, 0])
        found = pp.separation(BALL, other, tolerance=1e-6)
        assert found.lower - 1e-12 <= gap <= found.upper + 1e-12 and found.upper - found.lower <= 2e-6
        assert pp.overlap(BALL, other).overlaps == (gap < 0)
        points = pp.closest_points(BALL, other, tolerance=1e-6)
        assert points.best is not None and points.best.gap == pytest.approx(gap, abs=1e-5)


def test_batches_have_the_bits_of_single_questions() -> None:
    poses = np.random.default_rng(2).uniform(-0.5, 0.5, (60, 3))
    many = pp.separations(PLATE, PEG, poses, tolerance=1e-4)
    for i, pose in enumerate(poses):
        one = pp.separation(PLATE, PEG.translated(pose), tolerance=1e-4)
        assert abs(one.upper - many.upper[i]) <= 2e-4
        assert many.lower[i] <= one.upper and one.lower <= many.upper[i]
    threads = pp.separations(PLATE, PEG, poses, tolerance=1e-4, threads=2)
    assert threads == many and len(many) == 60
    hits = pp.overlaps(PLATE, PEG, poses)
    assert np.array_equal(hits == 1, many.upper < 0) or (np.abs(many.upper[(hits == 1) != (many.upper < 0)]) < 2e-4).all()


def test_a_batch_of_rays_has_the_bits_of_single_rays() -> None:
    origins = np.random.default_rng(4).uniform(-1, 1, (60, 3)) + [0, 2, 0]
    down = np.array([0.0, -1.0, 0.1])
    many = pp.cast_rays(PLATE, origins, down, 5.0, tolerance=1e-5)
    assert len(many) == 60 and set(many.hits) == {0, 1}
    for i, origin in enumerate(origins):
        one = pp.cast_ray(PLATE, origin, down, 5.0, tolerance=1e-5)
        assert (one.lower, one.upper) == (many.lower[i], many.upper[i])
        assert pp.STOPS[many.stops[i]] == one.stop and (one.best is not None) == (many.hits[i] == 1)
        if one.best is None:
            assert np.isnan(many.points[i]).all() and one.upper == 5.0
        else:
            assert np.array_equal(one.best.point, many.points[i]) and np.array_equal(one.best.normal, many.normals[i])
    assert pp.cast_rays(PLATE, origins, np.tile(down, (60, 1)), 5.0, tolerance=1e-5, threads=2) == many
    fan = pp.cast_rays(PLATE, [0.25, 2, 0], [[0, -1, 0], [0, 1, 0]])
    assert fan.hits.tolist() == [1, 0]
    assert pp.cast_rays(PLATE, origins[:1], down, budget=1).hits.tolist() == [-1]
    assert len(pp.cast_rays(PLATE, np.empty((0, 3)), down)) == 0
    assert len(pp.cast_rays(pp.circle(0.5), [[0, 2], [1, 2]], [0, -1])) == 2


def test_a_sweep_keeps_to_its_budget() -> None:
    few = pp.sweep(PLATE, PEG, start=[0, 3, 0], end=[0, 0, 0], budget=3)
    assert few.stop == "budget_spent" and few.touches is None


def test_forms_of_poses_agree() -> None:
    angle, way = 0.3, [0.1, 0.2, 0.3]
    quaternion = [0, 0, math.sin(angle / 2), math.cos(angle / 2)]
    matrix = np.eye(4)
    matrix[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    matrix[:3, 3] = way
    box = pp.cuboid([1, 2, 3])
    points = np.random.default_rng(1).uniform(-2, 2, (50, 3))
    expected = box.rotated([0, 0, 1], radians=angle).translated(way).distance(points)
    for pose in [[*way, *quaternion], matrix]:
        assert np.abs(box.placed(pose).distance(points) - expected).max() < 1e-12
    flat = pp.cuboid([1, 2])
    turned = flat.rotated(radians=angle).translated([0.1, 0.2])
    planar = np.array([[math.cos(angle), -math.sin(angle), 0.1], [math.sin(angle), math.cos(angle), 0.2], [0, 0, 1]])
    for pose in [[0.1, 0.2, angle], planar]:
        assert np.abs(flat.placed(pose).distance(points[:, :2]) - turned.distance(points[:, :2])).max() < 1e-12


def test_a_first_touch_lies_between_its_bounds() -> None:
    found = pp.sweep(BALL, BALL, start=[3, 0, 0], end=[-3, 0, 0], gap=1e-6)
    assert found.touches and found.lower <= 1 / 3 <= found.upper + 1e-6
    assert found.contact is not None and found.contact.point_a[0] == pytest.approx(0.5, abs=1e-3)
    apart = pp.sweep(BALL, BALL, start=[3, 2, 0], end=[-3, 2, 0])
    assert apart.touches is False and apart.upper == 1 and apart.contact is None
    # Both come towards each other.
    both = pp.sweep(BALL, BALL, start=[3, 0, 0], end=[0, 0, 0], a_start=[-3, 0, 0], a_end=[0, 0, 0], gap=1e-6)
    assert both.lower <= 5 / 6 <= both.upper + 1e-6


def test_a_track_says_what_a_search_says() -> None:
    track = pp.Track(PLATE, PEG)
    for i in range(30):
        pose = [1e-3 * i, 0.02 * i, 0]
        found, anew = track.separation(b=pose), pp.separation(PLATE, PEG.translated(pose), tolerance=1e-4)
        assert found.lower <= anew.upper and anew.lower <= found.upper
    track.forget()
    assert track.separation(b=[0, 2, 0]).lower > 1


def test_contacts_keep_their_names_from_step_to_step() -> None:
    track, plate = pp.Track(pp.cuboid([1, 0.1, 1]), pp.cuboid([0.2, 0.2, 0.2])), pp.cuboid([1, 0.1, 1])
    first = track.manifold(b=[0, 0.1495, 0])
    assert len(first) >= 4
    # Without a track, ids are those of places.
    anew = pp.manifold(plate, pp.cuboid([0.2, 0.2, 0.2]).translated([0, 0.1495, 0]))
    assert np.allclose(np.sort(anew.contacts.gap), np.sort(first.contacts.gap), atol=1e-4)
    for i in range(1, 20):
        again = track.manifold(b=[1e-4 * i, 0.1495, 0])
        assert set(again.contacts.id.tolist()) == set(first.contacts.id.tolist())
    assert len(track.manifold(b=[0, 0.3, 0])) == 0
    assert len(track.manifold(b=[0, 0.151, 0], margin=0.01, most=2)) == 2
    with pytest.raises(pp.QueryError, match="spacing"):
        track.manifold(spacing=-1.0)


def test_a_world_knows_what_is_hit_first() -> None:
    world = pp.World({"floor": pp.half_space([0, 1, 0], 0.0), "shelf": pp.cuboid([1, 0.1, 1]), "ball": BALL})
    world.set_poses({"shelf": [0, 2, 0], "ball": [0, 4, 0]})
    hits = world.first_impacts({"ball": [0, 0, 0]})
    assert [hit.bodies for hit in hits] == [("shelf", "ball"), ("floor", "ball")]
    # 4 - 0.5 - 2.05 m of 4 m, then 3.5 m.
    assert [hit.upper for hit in hits] == pytest.approx([0.3625, 0.875], abs=1e-4)
    assert hits[0].touches and hits[0].contact.normal[1] == pytest.approx(1, abs=1e-3)
    assert world.pose("ball")[1, 3] == 4
    assert world.first_impacts({"ball": [0, 5, 0]}) == []
    with pytest.raises(KeyError, match="no body is called"):
        world.first_impacts({"cup": [0, 0, 0]})
    with pytest.raises(KeyError, match="there are floor, shelf, ball"):
        world.pose("cup")


def test_a_world_that_steps_keeps_no_other_thread_waiting() -> None:
    # A thread that waited for the world with the interpreter's lock would stop the one that has the world.
    world = pp.World({"a": PLATE, "b": PEG}, margin=1e-3)

    def move() -> None:
        for i in range(50):
            world.set_poses({"b": [1e-3 * i, 0, 0]})
            world.first_impacts({"b": [0, 1, 0]}, gap=1e-3)
            world.pose("b")

    threads = [threading.Thread(target=move, daemon=True) for _ in range(4)]
    for thread in threads:
        thread.start()
    for _ in range(50):
        world.step()
    for thread in threads:
        thread.join(60)
    assert not any(thread.is_alive() for thread in threads)


def test_a_world_finds_its_pairs() -> None:
    scene = pp.Scene({"table": pp.cuboid([1, 0.1, 1]), "a": pp.ball(0.05), "b": pp.ball(0.05)})
    world = pp.World(scene, margin=1e-3)
    world.set_poses({"a": [0, 0.0995, 0], "b": [0.5, 3, 0]})
    [near] = world.step()
    assert (near.bodies, near.verdict) == (("table", "a"), "touching")
    assert near.lower <= -0.0005 <= near.upper and len(near.manifold) >= 1
    assert near.manifold.region_stop == "converged"
    world.set_poses({"b": [0.09, 0.0995, 0]})
    assert {near.bodies for near in world.step(threads=2)} == {("table", "a"), ("table", "b"), ("a", "b")}
    with pytest.raises(KeyError, match="there are table, a, b"):
        world.set_poses({"c": [0, 0, 0]})


def test_the_end_of_a_search_is_told_for_neighbours_without_contacts_too() -> None:
    world = pp.World({"a": BALL, "b": BALL}, margin=0.3)
    world.set_poses({"b": [1.29, 0, 0]})
    assert all(near.manifold.region_stop is not None for near in world.step() if near.manifold is not None)


def test_each_number_of_a_stop_has_its_word() -> None:
    poses = [[1.5, 0, 0]]
    for how in [{}, {"budget": 20, "tolerance": 1e-9}]:
        one, many = pp.separation(PLATE, PEG, **how), pp.separations(PLATE, PEG, [[0, 0, 0]], **how)
        assert pp.STOPS[many.stops[0]] == one.stop
    assert pp.STOPS[pp.separations(BALL, BALL, poses).stops[0]] == "converged"


def test_the_inertia_is_that_of_the_book() -> None:
    mass = pp.cuboid([0.1, 0.2, 0.3]).mass(1000)
    m = 6.0
    for i, (one, two) in enumerate([(0.2, 0.3), (0.1, 0.3), (0.1, 0.2)]):
        error = 2 * mass.second_moments_error
        assert mass.inertia[i, i] == pytest.approx(m / 12 * (one**2 + two**2), abs=error)
    assert error < 0.05 * mass.inertia[0, 0]
    disc = pp.ball(0.1, dimension=2).mass(10)
    assert disc.inertia == pytest.approx(10 * np.pi * 0.1**4 / 2, abs=2 * disc.second_moments_error)


def test_answers_are_frozen_and_can_be_pickled() -> None:
    for answer in [
        pp.separation(BALL, PEG),
        pp.manifold(BALL, PEG),
        pp.separations(BALL, PEG, [[1, 0, 0]]),
        BALL.at([0, 1, 0]),
        BALL.promise,
        pp.cast_ray(BALL, [0, 2, 0], [0, -1, 0]),
    ]:
        assert pickle.loads(pickle.dumps(answer)) == answer
        with pytest.raises(AttributeError):
            answer.lower = 0.0
        assert repr(answer).startswith(type(answer).__name__)


@pytest.mark.parametrize(
    ("ask", "error", "words"),
    [
        (lambda: pp.separation(BALL, pp.ball(1, dimension=2)), ValueError, "got 3D and 2D"),
        (lambda: pp.separation(pp.half_space([0, 1, 0], 0.0), pp.half_space([0, 1, 0], 0.0)), pp.QueryError, "bounded"),
        (lambda: pp.separation(BALL, BALL, tolerance=-1), pp.QueryError, "-1"),
        (lambda: pp.separations(BALL, BALL, [[0, 0, 0], [np.nan, 0, 0]]), pp.QueryError, "1"),
        (lambda: pp.separations(BALL, BALL, [0, 0, 0]), ValueError, "poses must have the shape (n, …)"),
        (lambda: pp.separations(BALL, BALL, np.zeros((2**40, 0))), ValueError, "poses must have the shape (n, …)"),
        (lambda: pp.separations(BALL, BALL, np.zeros((0, 5))), ValueError, "poses must have the shape (n, …)"),
        (lambda: pp.separations(BALL, BALL, [[0, 0, 0, 0, 0, 0, 0]]), ValueError, "poses[0]"),
        (lambda: pp.separations(BALL, BALL, np.ones((2, 4, 4))), ValueError, "poses[0]: the last row of a pose"),
        (lambda: pp.cast_ray(BALL, [0, 2, 0], [0, 0, 0]), pp.QueryError, "direction"),
        (lambda: pp.cast_ray(BALL, [0, 2], [0, 0, 1]), ValueError, "origin must have the shape (3,), got (2,)"),
        (lambda: pp.cast_rays(BALL, [[0, 2, 0]] * 2, [[0, 1, 0]] * 3), ValueError, "got 2 and 3"),
        (lambda: pp.cast_rays(BALL, [[0, 2, 0]] * 2, [[0, 1, 0], [0, 0, 0]]), ValueError, "rays[1]: "),
        (lambda: pp.cast_rays(BALL, np.zeros((2, 2)), [0, 1, 0]), ValueError, "shape (n, 3) or (3,), got (2, 2)"),
        (lambda: pp.cast_rays(BALL, [0, 2, 0], [0, 1, 0], tolerance=-1), pp.QueryError, "-1"),
        (lambda: pp.manifold(BALL, BALL, margin=-1), pp.QueryError, "got -1.0 m"),
        (lambda: bool(pp.overlap(PLATE, PEG, budget=1)), ValueError, "undecided"),
        (lambda: pp.Track(BALL, pp.ball(1, dimension=2)), ValueError, "got 3D and 2D"),
        (lambda: pp.World({"a": BALL}).first_impacts({"a": [np.nan, 0, 0]}), pp.Error, ""),
        (lambda: pp.sweep(BALL, BALL, start=[np.inf, 0, 0]), pp.Error, ""),
    ],
)
def test_what_cannot_be_asked_is_refused(ask: Any, error: type, words: str) -> None:
    with pytest.raises(error) as caught:
        ask()
    assert words in str(caught.value)


def test_one_of_many_raises_what_it_raises_alone() -> None:
    # It was a ValueError that knew neither parameter nor value.
    ball = pp.ball(0.5)
    with pytest.raises(pp.QueryError, match=r"^rays\[1\]: ") as caught:
        pp.cast_rays(ball, [[0, 2, 0]], [[0, -1, 0], [0, 0, 0]])
    with pytest.raises(pp.QueryError) as alone:
        pp.cast_ray(ball, [0, 2, 0], [0, 0, 0])
    assert caught.value.parameter == alone.value.parameter
    with pytest.raises(ValueError, match=r'^poses\["a"\] must have the shape'):
        pp.World({"a": ball}).set_poses({"a": [1, 2]})


def test_answers_without_an_array_on_one_side_differ() -> None:
    # Comparing None with an array raised.
    assert pp.half_space([0, 1, 0], 0).promise != pp.ball(0.5).promise
