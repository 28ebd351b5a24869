# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Writes the constructors of all primitives, from the catalogue: ``python generate.py``."""

from __future__ import annotations

import keyword
from pathlib import Path
from typing import Any

from palpate import _palpate

PLACE = Path(__file__).parent / "python" / "palpate" / "_shapes.py"

HEAD = '''\
# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The primitives, made by generate.py from the catalogue: what is changed here is lost."""

from __future__ import annotations

import math
from typing import Sequence

from numpy.typing import ArrayLike

from palpate._palpate import Shape, primitive

__all__ = [
{names}]


def _angle(name: str, radians: float | None, degrees: float | None) -> float:
    """The angle [rad], of which one of two units is given."""
    if (radians is None) == (degrees is None):
        raise TypeError(f"exactly one of {{name}}= [rad] and {{name}}_degrees= must be given")
    return math.radians(degrees) if degrees is not None else float(radians)  # type: ignore[arg-type]


def _columns(points: ArrayLike) -> int:
    """How many coordinates a vector or points have."""
    import numpy

    shape = numpy.shape(points)
    if not shape or shape[-1] not in (2, 3):
        raise ValueError(f"2 coordinates are needed in the plane, 3 in space, got the shape {{shape}}")
    return int(shape[-1])
'''

TYPES = {
    "Count": "int",
    "Vector": "ArrayLike",
    "Direction": "ArrayLike",
    "Points": "ArrayLike",
    "Rings": "Sequence[ArrayLike]",
}

SAYS = ("Vector", "Direction", "Points")


def constructor(entries: list[dict[str, Any]]) -> str:
    """The function for a primitive of one dimension, or of both."""
    # The example of the solid, where there is one of each dimension.
    first = entries[-1]
    name, parameters = first["name"], first["parameters"]
    dimensions = sorted(entry["dimension"] for entry in entries)
    has_angle = any(kind == "Angle" for _, kind, _, _ in parameters)
    telling = next((key for key, kind, _, _ in parameters if kind in SAYS), None)
    telling = telling and telling + "_" * keyword.iskeyword(telling)
    given: list[str] = ["*"] if has_angle else []
    values, about, example = [], [], []
    for (key, kind, unit, meaning), value in zip(parameters, first["example"], strict=True):
        parameter = key + "_" * keyword.iskeyword(key)
        if kind == "Angle":
            given += [f"{parameter}: float | None = None", f"{parameter}_degrees: float | None = None"]
            values.append(f'_angle("{parameter}", {parameter}, {parameter}_degrees)')
            about.append(f"{parameter}: {meaning} [rad].")
            about.append(f"{parameter}_degrees: the same [degrees]; one of the two is given.")
        else:
            given.append(f"{parameter}: {TYPES.get(kind, 'float')}")
            values.append(parameter)
            about.append(f"{parameter}: {meaning}" + (" [m]." if unit == "m" else "."))
        example.append(f"{parameter}={value}")
    if len(dimensions) == 1:
        dimension = str(dimensions[0])
    elif telling:
        dimension = f"_columns({telling})"
    else:
        dimension = "dimension"
        given += [] if has_angle else ["*"]
        given.append("dimension: int = 3")
        about.append("dimension: 2 in the plane, 3 in space.")
    of = "in the plane" if dimensions == [2] else "in space" if dimensions == [3] else "in the plane or in space"
    shown = f"{name}({', '.join(example)})"
    made = first["made"]
    lines = [f"def {name}(", *(f"    {one}," for one in given), ") -> Shape:"]
    lines += [f'    """{sentence(first["about"])}', "", f"    {sentence(first['origin'])} {sentence(of)}", ""]
    lines += ["    Args:", *(f"        {one}" for one in about), ""]
    raised = ["`ShapeError` if a number is out of range"]
    if has_angle:
        raised.append("`TypeError` unless one of an angle in radians and in degrees is given")
    lines += [f"    Raises {', '.join(raised)}.", ""]
    lines += ["    >>> import palpate as pp", f"    >>> pp.{shown}", f"    {made}", '    """']
    lines += [f'    return primitive("{name}", {dimension}, [{", ".join(values)}])']
    return "\n".join(lines) + "\n"


def sentence(text: str) -> str:
    """With a capital at its start and a point at its end."""
    return text[0].upper() + text[1:] + ("" if text.endswith(".") else ".")


def text() -> str:
    """The module."""
    by_name: dict[str, list[dict[str, Any]]] = {}
    for entry in _palpate.catalogue():
        by_name.setdefault(entry["name"], []).append(entry)
    names = sorted(by_name)
    quoted = "".join(f'    "{name}",\n' for name in names)
    return "\n\n".join([HEAD.format(names=quoted), *(constructor(by_name[name]) for name in names)])


if __name__ == "__main__":
    PLACE.write_text(text(), encoding="utf-8")
    print(f"{PLACE.name} written")
