# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Volumes of scanners lie where nibabel and SimpleITK put them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import palpate as pp
import pytest

nibabel = pytest.importorskip("nibabel")
sitk = pytest.importorskip("SimpleITK")

COUNTS = (5, 6, 7)
# Samples that are 100, where all others are 0: half of their value lies half a step from them.
DOTS = [(1, 2, 3), (3, 2, 1), (1, 4, 5)]
SPACING = np.array([1.0, 1.2, 0.9])
ORIGIN = np.array([12.0, -30.0, -45.0])

# A rotation about (1, 2, 3), and ways in which the axes of a scan lie: turned, exchanged, mirrored.
AXIS = np.array([1.0, 2.0, 3.0]) / np.sqrt(14)
CROSS = np.array([[0, -AXIS[2], AXIS[1]], [AXIS[2], 0, -AXIS[0]], [-AXIS[1], AXIS[0], 0]])
OBLIQUE = np.eye(3) + np.sin(0.7) * CROSS + (1 - np.cos(0.7)) * CROSS @ CROSS
DIRECTIONS = {
    "straight": np.eye(3),
    "to the left and the back": np.diag([-1.0, -1.0, 1.0]),
    "exchanged": np.eye(3)[[1, 2, 0]],
    "oblique": OBLIQUE,
    "left-handed": OBLIQUE @ np.diag([1.0, 1.0, -1.0]),
}

Place = Callable[[tuple[int, int, int]], Any]


def samples() -> Any:
    values = np.zeros(COUNTS, dtype=np.int16)
    for dot in DOTS:
        values[dot] = 100
    return values


def check(file: Path, place: Place) -> None:
    """Every dot is where `place` puts it [mm], to the right, the front and the top; its neighbours are outside."""
    scene = file.with_suffix(".json")
    volume = {"volume": {"file": file.name, "value": 50}}
    body = {"name": "scan", "shape": volume}
    scene.write_text(json.dumps({"palpate": 1, "dimension": 3, "bodies": [body]}))
    whole = pp.Scene.load(scene).whole
    for dot in DOTS:
        x, y, z = dot
        assert whole.distance(1e-3 * np.asarray(place(dot))) < -1e-4
        for beside in [(x + 1, y, z), (x, y - 1, z), (x, y, z + 1)]:
            assert whole.distance(1e-3 * np.asarray(place(beside))) > 1e-4


def of_itk(file: Path) -> Place:
    """ITK's places are to the left, the back and the top."""
    image = sitk.ReadImage(str(file))
    return lambda node: np.array([-1, -1, 1]) * image.TransformIndexToPhysicalPoint(node)


def of_nibabel(file: Path) -> Place:
    affine = nibabel.load(file).affine
    return lambda node: affine[:3, :3] @ node + affine[:3, 3]


@pytest.mark.parametrize("ending", ["nii", "nii.gz", "mha", "mhd", "nrrd", "nhdr"])
@pytest.mark.parametrize("lie", DIRECTIONS)
def test_what_simpleitk_writes_lies_where_it_reads_it(tmp_path: Path, lie: str, ending: str) -> None:
    image = sitk.GetImageFromArray(samples().transpose())
    image.SetSpacing(SPACING.tolist())
    image.SetOrigin(ORIGIN.tolist())
    image.SetDirection(DIRECTIONS[lie].ravel().tolist())
    file = tmp_path / f"scan.{ending}"
    sitk.WriteImage(image, str(file))
    check(file, of_itk(file))
    if "nii" in ending:
        check(file, of_nibabel(file))


@pytest.mark.parametrize("form", ["sform", "qform"])
@pytest.mark.parametrize("lie", DIRECTIONS)
def test_what_nibabel_writes_lies_where_it_reads_it(tmp_path: Path, lie: str, form: str) -> None:
    affine = np.eye(4)
    affine[:3, :3] = DIRECTIONS[lie] * SPACING
    affine[:3, 3] = ORIGIN
    image = nibabel.Nifti1Image(samples(), affine)
    image.set_sform(affine, code=1 if form == "sform" else 0)
    image.set_qform(affine, code=1 if form == "qform" else 0)
    file = tmp_path / "scan.nii"
    nibabel.save(image, file)
    check(file, of_nibabel(file))
    check(file, of_itk(file))


@pytest.mark.parametrize(
    ("ending", "head"),
    [
        ("mha", "Orientation = 0 1 0 -1 0 0 0 0 1\nPosition = 1 2 3\nElementSize = 1 1.2 0.9\n"),
        ("mha", "Rotation = 0 1 0 -1 0 0 0 0 1\nOrigin = 1 2 3\nAnatomicalOrientation = ???\n"),
        ("mha", "TransformMatrix = 1 0 0 0 1 0 0 0 -1\nOffset = 1 2 3\nAnatomicalOrientation = RAS\n"),
        ("mha", "Offset: 1 2 3\nElementSpacing: 1 -1.2 0.9\nBinaryDataByteOrderMSB: 0\n"),
        ("nrrd", "space: RAS\nspace directions: (1,0,0) (0,0,1.2) (0,0.9,0)\nspace origin: (1,2,3)\n"),
        ("nrrd", "space: LAS\nspace directions: (1,0,0) (0,1.2,0) (0,0,0.9)\nspace origin: (1,2,3)\n"),
        ("nrrd", "space: LPS\nspace directions: (1,0,0) (0,-1.2,0) (0,0,0.9)\nspace origin: (1,2,3)\n"),
    ],
)
def test_heads_of_other_programs_lie_where_itk_reads_them(tmp_path: Path, ending: str, head: str) -> None:
    if ending == "mha":
        first = "ObjectType = Image\nNDims = 3\nDimSize = 5 6 7\n"
        last = "ElementType = MET_SHORT\nElementDataFile = LOCAL\n"
    else:
        first = "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 6 7\n"
        last = "endian: little\nencoding: raw\n\n"
    file = tmp_path / f"scan.{ending}"
    file.write_bytes((first + head + last).encode() + samples().astype("<i2").tobytes(order="F"))
    check(file, of_itk(file))


def test_a_place_on_which_itk_and_nibabel_differ_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "scan.nii"
    nibabel.save(nibabel.Nifti1Image(samples(), None), file)
    first = (0, 0, 0)
    assert np.abs(of_nibabel(file)(first) - of_itk(file)(first)).max() > 1
    with pytest.raises(pp.SceneError, match="qform_code and sform_code are 0"):
        check(file, of_itk(file))
