# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Answers have the fields that the types of Rust have, and tell the new names of those that they had."""

from __future__ import annotations

import copy
import json
import math
import sys
from dataclasses import fields
from pathlib import Path
from typing import get_args, get_type_hints

import numpy as np
import palpate as pp
import pytest
from palpate import _answer, _answers, _examples

PACKAGE = Path(__file__).parents[1]
BALL = pp.ball(0.5)
APART = pp.ball(0.5).translated([2, 0, 0])
SCHEMA = json.loads((PACKAGE / "answers.schema.json").read_text(encoding="utf-8"))
# The type of a separation inside of another answer has the name of Rust.
INNER = {name: of for name, of in SCHEMA["$defs"].items() if "properties" in of and name != "Certified"}
SHARED = SCHEMA["properties"] | INNER


def test_the_classes_are_those_of_the_schema() -> None:
    sys.path.insert(0, str(PACKAGE))
    try:
        import generate_answers
    finally:
        sys.path.pop(0)
    for name, text in generate_answers.files().items():
        assert (generate_answers.PACKAGE / name).read_text(encoding="utf-8") == text, "run: cargo xtask renew"


@pytest.mark.parametrize("name", SHARED)
def test_a_class_has_the_fields_of_its_type_in_rust(name: str) -> None:
    added = get_type_hints(getattr(_examples, name)) if hasattr(getattr(_examples, name), "__dataclass_fields__") else {}
    own = {field.name for field in fields(getattr(pp, name))} - set(added)
    assert own == set(SHARED[name]["properties"])
    assert not set(added) & set(SHARED[name]["properties"])


def test_contacts_have_the_fields_of_a_contact() -> None:
    assert _answer.names(pp.Contacts) == _answer.names(pp.Contact)


def test_numbers_become_what_the_class_says() -> None:
    found = pp.separation(BALL, APART)
    assert isinstance(found.best, pp.Nearest) and isinstance(found.best.point, np.ndarray)
    assert found.best.point.dtype == np.float64 and type(found.evaluations) is int
    assert found.stop in get_args(_answers.Stop)
    assert pp.ball(0.5, dimension=2).mass().second_moments.shape == (2, 2)
    apart = pp.manifold(BALL, APART)
    assert apart.contacts.point_a.shape == (0, 3) and apart.contacts.gap.shape == (0,)
    assert apart.contacts.id.dtype == np.uint64 and len(apart) == 0


def test_infinite_numbers_stay() -> None:
    plate, peg = pp.cuboid([0.6, 0.4, 0.6]) - pp.cylinder(radius=0.1005, height=1.0), pp.cylinder(radius=0.1, height=0.6)
    assert pp.sweep(plate, peg, start=[0, 3, 0], end=[0, 0, 0], budget=3).upper == math.inf
    down = [{"body": "peg", "from": {"translation": [0, 3, 0]}, "to": {"translation": [0, 0, 0]}}]
    scene = pp.Scene({"plate": plate, "peg": peg}, motions=down)
    [pair] = scene.ask({"question": "sweep", "budget": 3})["pairs"]
    assert pair["verdict"] == "undecided" and pair["upper"] == math.inf
    assert pp.manifold(BALL, APART).distance_at_most == math.inf


@pytest.mark.parametrize(
    ("answer", "old", "new"),
    [
        (pp.closest_points(BALL, APART).best, "gap_m", "gap"),
        (BALL.at([0, 1, 0]), "distance_m", "distance"),
        (pp.separation(BALL, APART), "point", "best.point"),
        (pp.closest_points(BALL, APART), "contact", "best"),
        (pp.cast_ray(BALL, [0, 2, 0], [0, -1, 0]), "normal", "best.normal"),
        (pp.manifold(BALL, BALL), "gaps", "contacts.gap"),
        (pp.World({"a": BALL, "b": BALL}).step()[0], "a", "bodies[0]"),
    ],
)
def test_an_old_name_tells_the_new_one(answer: object, old: str, new: str) -> None:
    with pytest.raises(AttributeError, match=f"`{old}` is now `") as raised:
        getattr(answer, old)
    assert str(raised.value) == f"`{old}` is now `{new}`"
    assert eval(f"answer.{new}", {"answer": answer}) is not None


def test_a_name_that_never_was_is_told_as_python_does() -> None:
    found = pp.separation(BALL, APART)
    with pytest.raises(AttributeError, match="'Separation' object has no attribute 'volume_m3'"):
        found.volume_m3  # noqa: B018
    assert copy.deepcopy(found) == found
