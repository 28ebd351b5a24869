# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Writes the classes of answers that Rust has too, from their schema: ``python generate_answers.py``.

``cargo xtask renew`` writes the schema from the types of Rust, whose comments say what each field is. Examples, methods
and what Python adds stand in ``_examples.py``.
"""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path
from textwrap import fill, indent
from typing import Any

FOLDER = Path(__file__).parent
PACKAGE = FOLDER / "python" / "palpate"
LICENCE = """\
# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""

HEAD = f'''\
{LICENCE}"""Answers that Rust has too, made by generate_answers.py: what is changed here is lost.

Lengths are in metres. Where an answer has ``lower`` and ``upper``, the true value is between them, rounding included.
Points and vectors have the shape (D,), matrices (D, D).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate import _examples
from palpate._answer import Floats
'''

RENAMED = f'''\
{LICENCE}"""New names of keys that answers had before, made by generate_answers.py: what is changed here is lost."""

from __future__ import annotations

KEYS = {{
'''

SINGLE = {"number": "float", "integer": "int", "boolean": "bool", "string": "str", "array": "Floats"}
# What is in arrays. Rows of vectors and of matrices are numbers too.
MANY = {
    "float": "Floats",
    "Floats": "Floats",
    "int": "NDArray[np.uint64]",
    "bool": "NDArray[np.bool_]",
    "str": "NDArray[np.str_]",
}
WIDTH = 119


class Classes:
    """The classes of a schema."""

    def __init__(self, schema: dict[str, Any]) -> None:
        own, inner = schema["properties"], schema["$defs"]
        words = {name: found for name, found in inner.items() if "oneOf" in found}
        self.words = {name: [one["const"] for one in found["oneOf"]] for name, found in words.items()}
        # The type of an answer that is a field of another has the name that it has as an answer.
        self.names = {
            name: next((answer for answer, of in own.items() if of == found), name) for name, found in inner.items()
        }
        self.schemas = own | {self.names[name]: found for name, found in inner.items() if name not in words}
        self.rows: set[str] = set()

    def kind(self, schema: dict[str, Any]) -> str:
        """The type of a value in Python."""
        if "$ref" in schema:
            return self.names[schema["$ref"].removeprefix("#/$defs/")]
        if "anyOf" in schema:
            one, none = schema["anyOf"]
            assert none == {"type": "null"}
            return f"{self.kind(one)} | None"
        name, *none = [schema["type"]] if isinstance(schema["type"], str) else schema["type"]
        kind = SINGLE[name]
        if name == "array":
            item = self.kind(schema["items"])
            if item in self.schemas:
                self.rows.add(item)
            kind = f"{item}s" if item in self.schemas else MANY[item]
        return f"{kind} | None" if none else kind

    def many(self, kind: str) -> str:
        """The type of an array with a row for each value."""
        return MANY["str" if kind in self.words else kind]

    def text(self) -> str:
        """The module."""
        by_hand = read_examples()
        aliases = [f"{name}: TypeAlias = Literal[{quoted(words)}]" for name, words in sorted(self.words.items())]
        parts = [HEAD + "\n" + "\n".join(aliases) + "\n"]
        for name, schema in self.schemas.items():
            kinds = {key: self.kind(of) for key, of in schema["properties"].items()}
            parts.append(written(name, schema, kinds, by_hand[name]))
        for row in sorted(self.rows):
            schema = self.schemas[row]
            kinds = {key: self.many(self.kind(of)) for key, of in schema["properties"].items()}
            parts.append(written(f"{row}s", schema, kinds, by_hand[f"{row}s"]))
        return "\n\n".join(parts)


def written(name: str, schema: dict[str, Any], kinds: dict[str, str], by_hand: str) -> str:
    """A class."""
    said, arrow, example = by_hand.partition(">>> ")
    summary, _, more = said.partition("Fields:\n")
    lines = ["@dataclass(frozen=True, eq=False, kw_only=True)", f"class {name}(_examples.{name}):"]
    paragraphs = (summary.strip() or plain(schema["description"])).split("\n\n")
    about = "\n\n".join(fill(part, WIDTH - 4) for part in paragraphs)
    fields = [fill(f"{key}: {field(schema['properties'][key])}", WIDTH - 8, subsequent_indent="    ") for key in kinds]
    told = indent("\n".join(fields), "    ") + "\n" + more.rstrip()
    doc = f'"""{about}\n\nFields:\n{told.rstrip()}\n\n{arrow}{example.rstrip()}\n"""'
    return "\n".join([*lines, indent(doc, "    "), "", *(f"    {key}: {kind}" for key, kind in kinds.items()), ""])


def field(schema: dict[str, Any]) -> str:
    """What a field is, in one paragraph."""
    return " ".join(plain(schema["description"]).split())


def plain(text: str) -> str:
    """A comment of Rust without its example and its links, in the words of Python."""
    before = text.partition("\n\n```")[0]
    linked = re.sub(r"\[(`[^`]+`)\](\([^)]*\))?", r"\1", before)
    for rust, python in {"`true`": "`True`", "`false`": "`False`", "`None`": "None"}.items():
        linked = linked.replace(rust, python)
    return re.sub("`([^`]+)`", r"``\1``", linked)


def quoted(words: list[str]) -> str:
    return ", ".join(f'"{word}"' for word in words)


def read_examples() -> dict[str, str]:
    """The docstrings that are written by hand."""
    module = ast.parse((PACKAGE / "_examples.py").read_text(encoding="utf-8"))
    return {node.name: ast.get_docstring(node) or "" for node in module.body if isinstance(node, ast.ClassDef)}


def renamed(rows: list[list[str]]) -> str:
    """The table of new names."""
    table = {old: new for old, new in rows if old.isidentifier() and new.isidentifier()}
    return RENAMED + "".join(f'    "{old}": "{new}",\n' for old, new in table.items()) + "}\n"


def files() -> dict[str, str]:
    """The modules, by their names."""
    schema = json.loads((FOLDER / "answers.schema.json").read_text(encoding="utf-8"))
    return {"_answers.py": Classes(schema).text(), "_renamed.py": renamed(schema["renamed"])}


if __name__ == "__main__":
    for name, text in files().items():
        (PACKAGE / name).write_text(text, encoding="utf-8")
        print(f"{name} written")
