# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0

"""What MuJoCo answers about the pairs of a question.

    python beside.py QUESTION ANSWER

QUESTION and ANSWER are files of JSON. `exchange.rs` says what is in them. All lengths are in
metres, quaternions have their real part first.
"""

import ctypes
import json
import os
import pathlib
import sys
import time

import mujoco
import numpy as np

# How often each collision is timed; the fastest counts.
REPEATS = 3

# The step of the differences that measure how steep a field is, as a share of the body's size.
STEP = 1e-7

PACKAGE = pathlib.Path(mujoco.__file__).parent


class Plugin(ctypes.Structure):
    """The head of `mjpPlugin`, of MuJoCo's header `mjplugin.h`."""

    _fields_ = [
        ("name", ctypes.c_char_p),
        ("nattribute", ctypes.c_int),
        ("attributes", ctypes.c_void_p),
        ("capabilityflags", ctypes.c_int),
        ("needstage", ctypes.c_int),
        *[
            (name, ctypes.c_void_p)
            for name in (
                "nstate",
                "nsensordata",
                "init",
                "destroy",
                "copy",
                "reset",
                "compute",
                "advance",
                "visualize",
                "actuator_act_dot",
                "sdf_distance",
                "sdf_gradient",
            )
        ],
        (
            "sdf_staticdistance",
            ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p),
        ),
    ]


def library(folder, name):
    """The path of a shared library in a folder of the package."""
    endings = (".so", ".dylib", ".dll")
    for path in sorted((PACKAGE / folder).iterdir()):
        if path.name.removeprefix("lib").startswith(name) and any(
            ending in path.name for ending in endings
        ):
            return str(path)
    sys.exit(f"the package mujoco has no library {name}")


def field(body):
    """The plugin's own field of a body, as a function of an array of points."""
    core = ctypes.CDLL(library("", "mujoco"))
    core.mjp_getPlugin.restype = ctypes.POINTER(Plugin)
    slot = ctypes.c_int()
    plugin = core.mjp_getPlugin(body["plugin"].encode(), ctypes.byref(slot))
    if not plugin:
        sys.exit(f"MuJoCo has no plugin {body['plugin']}")
    distance = plugin.contents.sdf_staticdistance
    numbers = [number for _, number in body["attributes"]]
    attributes = np.array(numbers, dtype=np.float64)

    def values(points):
        points = np.ascontiguousarray(points, dtype=np.float64)
        first, stride = points.ctypes.data, points.strides[0]
        at = attributes.ctypes.data
        return np.array([distance(first + i * stride, at) for i in range(len(points))])

    return values


def about(body):
    """The values of a plugin's field, and how steep it is, at the points of a body."""
    values = field(body)
    points = np.array(body["points"])
    step = STEP * body["size"]
    slopes = []
    for axis in np.eye(3):
        rise = values(points + step * axis) - values(points - step * axis)
        slopes.append(rise / (2 * step))
    steepness = np.linalg.norm(slopes, axis=0)
    return {"values": values(points).tolist(), "steepness": steepness.tolist()}


def model(pair, collide):
    """Two free bodies."""
    instances, meshes, bodies = "", "", ""
    for name, body in zip("ab", pair["bodies"]):
        config = "".join(
            f'<config key="{key}" value="{number!r}"/>' for key, number in body["attributes"]
        )
        instances += (
            f'<plugin plugin="{body["plugin"]}">'
            f'<instance name="{name}">{config}</instance></plugin>'
        )
        meshes += f'<mesh name="{name}"><plugin instance="{name}"/></mesh>'
        bodies += (
            f'<body><freejoint/><geom type="sdf" mesh="{name}" contype="{collide}" '
            f'conaffinity="{collide}"><plugin instance="{name}"/></geom></body>'
        )
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><extension>{instances}</extension><asset>{meshes}</asset>"
        f"<worldbody>{bodies}</worldbody></mujoco>"
    )


def collide(model, data, pose):
    """Looks for contacts; the time that it took [ns]."""
    data.qpos[:7] = [0, 0, 0, 1, 0, 0, 0]
    data.qpos[7:] = pose
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    best = float("inf")
    for _ in range(REPEATS):
        start = time.perf_counter_ns()
        mujoco.mj_collision(model, data)
        best = min(best, time.perf_counter_ns() - start)
    return best


def beside(pair):
    """What MuJoCo finds for each pose of a pair."""
    first, second = (field(body) for body in pair["bodies"])
    # The call itself: the same two bodies, which are told not to collide.
    idle = model(pair, collide=0)
    data = mujoco.MjData(idle)
    call = float(np.median([collide(idle, data, pose) for pose in pair["poses"]]))
    active = model(pair, collide=1)
    data = mujoco.MjData(active)
    times, distances = [], []
    for pose in pair["poses"]:
        times.append(max(collide(active, data, pose) - call, 0.0))
        distances.append(min((contact.dist for contact in data.contact), default=None))
    turned = []
    for pose, witness in zip(pair["poses"], pair["witnesses"]):
        matrix = np.zeros(9)
        mujoco.mju_quat2Mat(matrix, np.array(pose[3:]))
        turned.append(matrix.reshape(3, 3).T @ (np.array(witness) - pose[:3]))
    return {
        "times": times,
        "distances": distances,
        "at_witnesses": np.maximum(first(pair["witnesses"]), second(turned)).tolist(),
    }


def main():
    question, answer = sys.argv[1:]
    with open(question, encoding="utf-8") as file:
        asked = json.load(file)
    mujoco.mj_loadPluginLibrary(library("plugin", "sdf_plugin"))
    answers = {
        "version": mujoco.__version__,
        "bodies": [about(body) for body in asked["bodies"]],
        "pairs": [beside(pair) for pair in asked["pairs"]],
    }
    # Renamed at the end: an interrupted run leaves no half of an answer.
    unfinished = answer + ".unfinished"
    with open(unfinished, "w", encoding="utf-8") as file:
        json.dump(answers, file)
    os.replace(unfinished, answer)


main()
