# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The stub says what the module has, and the package and its README pass a strict check of types."""

from __future__ import annotations

import doctest
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).parents[1]


def passes(*arguments: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *arguments], cwd=PACKAGE, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_is_that_of_the_module() -> None:
    passes("mypy.stubtest", "palpate._palpate", "--mypy-config-file", "pyproject.toml")


def test_the_readme_passes_a_strict_check(tmp_path: Path) -> None:
    text = (PACKAGE / "README.md").read_text(encoding="utf-8")
    examples = doctest.DocTestParser().get_examples(text)
    program = tmp_path / "readme.py"
    program.write_text("".join(example.source for example in examples), encoding="utf-8")
    passes("mypy", "--strict", "--package", "palpate")
    passes("mypy", "--strict", str(program))
