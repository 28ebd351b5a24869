# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The package as it is installed, and the workflow that makes it for other systems."""

from __future__ import annotations

import importlib.metadata
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
import yaml

PACKAGE = Path(__file__).parents[1]
WORKFLOW = PACKAGE.parents[1] / ".github" / "workflows" / "release.yml"


def test_the_wheel_has_what_it_needs() -> None:
    files = importlib.metadata.files("palpate") or []
    names = [file.name for file in files]
    if "palpate.pth" in names:
        pytest.skip("installed where it is developed")
    assert sum(name.endswith((".so", ".pyd")) for name in names) == 1
    assert {"py.typed", "_palpate.pyi", "LICENSE-MIT", "LICENSE-APACHE"} <= set(names)
    wheel = next(file for file in files if file.name == "WHEEL").read_text()
    assert "Tag: cp310-abi3-" in wheel


def test_the_program_has_its_exit_status(tmp_path: Path) -> None:
    program = [sys.executable, "-m", "palpate"]
    good = subprocess.run([*program, "shapes"], capture_output=True, text=True, check=False)
    assert good.returncode == 0 and "cuboid" in good.stdout
    bad = subprocess.run([*program, "check", "no/such.json"], capture_output=True, text=True, check=False)
    assert bad.returncode == 2 and "no/such.json" in bad.stderr
    script = shutil.which("palpate", path=sysconfig.get_path("scripts"))
    assert script
    assert subprocess.run([script, "--version"], capture_output=True, check=False).returncode == 0


def test_the_workflow_fits_the_package() -> None:
    workflow = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))
    assert set(workflow["jobs"]) == {"program", "wheel", "source", "sums", "publish"}
    project = importlib.metadata.metadata("palpate")
    steps = workflow["jobs"]["wheel"]["steps"]
    version = next(step["with"]["python-version"] for step in steps if "setup-python" in step.get("uses", ""))
    assert project["Requires-Python"] == f">={version}"
    systems = {entry["target"] for entry in workflow["jobs"]["wheel"]["strategy"]["matrix"]["include"]}
    assert len(systems) == 6
