# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What a scene says besides its bodies, as scene files do."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from palpate._palpate import Shape


def furnished(text: str, materials: Mapping[str, Any], parts: Mapping[str, Any]) -> str:
    """The text of a scene with materials of its bodies, and further keys."""
    scene = json.loads(text)
    bodies = {body["name"]: body for body in scene["bodies"]}
    if not isinstance(materials, Mapping):
        raise TypeError(f"materials must be a dict of the names of bodies, got {materials!r}")
    for name, material in materials.items():
        if name not in bodies:
            raise KeyError(f"no body is called {name!r}: there are {', '.join(bodies)}")
        bodies[name]["material"] = material
    return json.dumps(scene | dict(parts), default=_written)


def question(asked: Mapping[str, Any] | str) -> str:
    """A question to a scene as JSON."""
    return asked if isinstance(asked, str) else json.dumps(asked, default=_written)


def _written(value: Any) -> Any:
    """What is no JSON by itself."""
    match value:
        case Shape():
            return json.loads(value.to_json())
        case np.ndarray() | np.generic():
            return value.tolist()
        case Mapping():
            return dict(value)
        case _:
            raise TypeError(f"a scene holds numbers, texts, lists, dicts, arrays and shapes, got a {type(value).__name__}")
