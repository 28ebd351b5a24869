# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0

"""Signed distances of a mesh by libigl, MeshLib and Open3D, and how long they take.

    python beside.py QUESTION ANSWER

QUESTION and ANSWER are files of JSON; `beside.rs` says what is in them. Lengths are in metres,
times in nanoseconds. All runs on one processor, which must be chosen before packages start threads.
"""

import os

if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

import json
import sys
import time

import igl
import meshlib.mrmeshnumpy
import meshlib.mrmeshpy as meshlib_
import numpy as np

try:
    import open3d
except ImportError as error:
    # It needs libraries of the system that pip does not install, as libusb.
    open3d = None
    print(f"nothing is measured beside Open3D: {error}", file=sys.stderr)

# How often each is timed; the fastest counts.
REPEATS = 3


def timed(ask, repeats=REPEATS):
    """The answer of `ask`, and the fastest of its times."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter_ns()
        answer = ask()
        times.append(time.perf_counter_ns() - start)
    return answer, min(times)


def by_libigl(vertices, faces, points, sign, repeats=REPEATS):
    ask = lambda: igl.signed_distance(points, vertices, faces, sign)[0]
    return timed(ask, repeats)


def by_open3d(vertices, faces, points):
    scene = open3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(
        open3d.core.Tensor(vertices.astype(np.float32)),
        open3d.core.Tensor(faces.astype(np.uint32)),
    )
    asked = open3d.core.Tensor(points.astype(np.float32))
    return timed(lambda: scene.compute_signed_distance(asked, nthreads=1).numpy())


def by_meshlib(vertices, faces, cell):
    """The narrow band of OpenVDB, three cells on each side."""
    mesh = meshlib.mrmeshnumpy.meshFromFacesVerts(faces.astype(np.int32), vertices)
    params = meshlib_.MeshToVolumeParams()
    params.type = meshlib_.MeshToVolumeParamsType.Signed
    params.voxelSize = meshlib_.Vector3f(cell, cell, cell)
    params.surfaceOffset = 3
    return timed(lambda: meshlib_.meshToVolume(meshlib_.MeshPart(mesh), params))[1]


def nodes(origin, cell, counts):
    axes = [origin[i] + cell * np.arange(counts[i]) for i in range(3)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def main(question, answer):
    with open(question, encoding="utf-8") as file:
        asked = json.load(file)
    vertices = np.array(asked["vertices"])
    faces = np.array(asked["faces"], dtype=np.int64)
    points = np.array(asked["points"])
    winding = igl.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    normal = igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL
    crossing = [np.array(asked["crossing"][0]), np.array(asked["crossing"][1], dtype=np.int64)]
    answers = {} if open3d is None else {"open3d": by_open3d(vertices, faces, points)}
    answers |= {
        "libigl": by_libigl(vertices, faces, points, normal),
        "libigl_winding": by_libigl(*crossing, points, winding),
    }
    grid = nodes(asked["origin"], asked["cell"], asked["counts"])
    all_nodes = by_libigl(vertices, faces, grid, normal, 1)[1]
    result = {
        "distances": {name: found.astype(float).tolist() for name, (found, _) in answers.items()},
        "times": {name: least / len(points) for name, (_, least) in answers.items()},
        "all_nodes": all_nodes,
        "band": by_meshlib(vertices, faces, asked["cell"]),
    }
    with open(answer, "w", encoding="utf-8") as file:
        json.dump(result, file)


main(*sys.argv[1:])
