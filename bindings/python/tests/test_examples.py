# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Every public name has a docstring whose example runs."""

from __future__ import annotations

import doctest
import inspect
from collections.abc import Iterator

import palpate as pp
import pytest


def documented() -> Iterator[tuple[str, object]]:
    """The public names of the package, and those of its classes that are its own."""
    for name in pp.__all__:
        value = getattr(pp, name)
        yield name, value
        if inspect.ismodule(value):
            for key, member in vars(value).items():
                if not key.startswith("_") and getattr(member, "__module__", "") == value.__name__:
                    yield f"{name}.{key}", member
        if inspect.isclass(value) and value.__module__.startswith("palpate"):
            own = {key: member for key, member in vars(value).items() if not key.startswith("_")}
            for key, member in own.items():
                if callable(member) or inspect.isdatadescriptor(member) or isinstance(member, staticmethod):
                    yield f"{name}.{key}", getattr(value, key)


PUBLIC = [
    (name, value)
    for name, value in documented()
    # The fields of an answer are told at the field.
    if not isinstance(value, (tuple, str, int, float, bool, type(None)))
]


@pytest.mark.parametrize(("name", "value"), PUBLIC, ids=[name for name, _ in PUBLIC])
def test_the_docstring_has_an_example_that_runs(name: str, value: object) -> None:
    text = inspect.getdoc(value) or ""
    assert text, f"{name} has no docstring"
    examples = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    assert examples.examples, f"{name} has no example"
    report: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    failed, _ = runner.run(examples, out=report.append)
    assert not failed, "".join(report)


def test_all_public_names_are_listed() -> None:
    assert len(set(pp.__all__)) == len(pp.__all__)
    assert set(pp.__all__) <= set(dir(pp))
