# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What all answers are: frozen objects with names, with arrays where there are many, made of what Rust tells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from types import NoneType
from typing import TYPE_CHECKING, Any, NoReturn, TypeAlias, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from palpate._renamed import KEYS

Floats: TypeAlias = NDArray[np.float64]

# Attributes that this package had and that have a new name, by their classes.
_NEAREST = {"point": "best.point", "normal": "best.normal"}
_BODIES = {"a": "bodies[0]", "b": "bodies[1]"}
_CONTACTS = {
    "points_a": "contacts.point_a",
    "points_b": "contacts.point_b",
    "normals": "contacts.normal",
    "gaps": "contacts.gap",
}
_ATTRIBUTES = {
    "BodyImpact": _BODIES,
    "ClosestPoints": {"contact": "best"},
    "Manifold": _CONTACTS
    | {
        "ids": "contacts.id",
        "lower": "separation.lower",
        "upper": "distance_at_most",
        "stop": "region_stop",
        "evaluations": "separation.evaluations",
    },
    "MeshContacts": _CONTACTS | {"faces": "elements"},
    "Neighbours": _BODIES | {"stop": "manifold.region_stop"},
    "Overlap": _NEAREST,
    "RayCast": _NEAREST,
    "Separation": _NEAREST,
}


class Answer:
    """Equality of fields that may be arrays, and new names of attributes."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(_equal(value, vars(other)[name]) for name, value in vars(self).items())

    __hash__ = None  # type: ignore[assignment]

    # A check of types would take each name for an attribute.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:
            kind = type(self).__name__
            key = KEYS.get(name)
            new = _ATTRIBUTES.get(kind, {}).get(name) or (key if key in names(type(self)) else None)
            problem = f"`{name}` is now `{new}`" if new else f"{kind!r} object has no attribute {name!r}"
            raise AttributeError(problem, name=name, obj=self)


def _equal(one: object, two: object) -> bool:
    if isinstance(one, np.ndarray) and isinstance(two, np.ndarray):
        return bool(np.array_equal(one, two, equal_nan=one.dtype.kind == "f"))
    if isinstance(one, np.ndarray) or isinstance(two, np.ndarray):
        return False
    # NaN stands for what is not known.
    return bool(one == two or (one != one and two != two))


@cache
def names(kind: type) -> tuple[str, ...]:
    """The names of the fields of a class of answers."""
    return tuple(field.name for field in fields(kind))


def built(kind: type, told: Mapping[str, Any]) -> Any:
    """The answer of a class, of what serde writes: each value becomes what the class says of its field."""
    kinds = _kinds(kind)
    return kind(**{name: _filled(kinds.get(name), value) for name, value in told.items()})


def columns(kind: type, of: type, rows: Sequence[Mapping[str, Any]], dimension: int) -> Any:
    """The answer of a class that has an array for each field of another, with a row for each of these answers."""
    arrays, kinds = {}, _kinds(kind)
    for name, single in _kinds(of).items():
        shape = (len(rows), dimension) if _dtype(single) else (len(rows),)
        arrays[name] = np.array([row[name] for row in rows], _dtype(kinds[name])).reshape(shape)
    return kind(**arrays)


def _filled(kind: Any, value: Any) -> Any:
    if isinstance(value, dict) and is_dataclass(kind):
        return built(kind, value)  # type: ignore[arg-type]
    if isinstance(value, (list, tuple)) and _dtype(kind):
        return np.array(value, _dtype(kind))
    return value


@cache
def _kinds(kind: type) -> dict[str, Any]:
    """The types of the fields of a class; of what may be None, the type of what is not."""
    hints = get_type_hints(kind)
    return {name: _known(hints[name]) for name in names(kind)}


def _known(hint: Any) -> Any:
    rest = [part for part in get_args(hint) if part is not NoneType]
    return rest[0] if len(rest) == 1 and NoneType in get_args(hint) else hint


@cache
def _dtype(kind: Any) -> Any:
    """The type of the numbers of an array; None of what is no array."""
    return get_args(get_args(kind)[1])[0] if get_origin(kind) is np.ndarray else None
