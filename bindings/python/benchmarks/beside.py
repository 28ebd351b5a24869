# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Times palpate beside other packages: ``python benchmarks/beside.py``, in an environment with palpate built for release.

Each peer gets an environment of its own under ``target/peers``, since their versions of NumPy differ, and is asked on one
processor; palpate is asked before and after it, since a machine is not as fast in one minute as in the next, and the
shorter time counts. A peer that cannot be installed is named and left out. Values are compared before times. The lines are
keys and numbers; the last ones are ratios with their bars: how many times as fast as the peer palpate is at least.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import venv
from pathlib import Path

import numpy as np

import palpate as pp
from bars import Table

HERE = Path(__file__).resolve().parent

#: Where the environments are.
FOLDER = HERE.parents[2] / "target" / "peers"

#: What each peer needs.
PEERS = {
    "numpy_by_hand": ["numpy==2.4.6"],
    "sdfcad": ["sdfcad==0.5.2", "numpy<2"],
    "peclet": ["peclet-geom==1.0.1", "numpy==2.4.6"],
    "jax": ["jax==0.10.2", "numpy==2.4.6"],
    "trimesh": ["trimesh==5.2.0", "rtree", "scipy", "numpy==2.4.6"],
    "libigl": ["libigl==2.6.3", "numpy==2.4.6"],
    "open3d": ["open3d==0.20.0", "numpy==2.4.6"],
    "coal": ["coal==3.0.3", "numpy==2.4.6"],
    "mujoco": ["mujoco==4.0.0", "numpy==2.4.6"],
}

#: Our key, the peer's, and the bar of the peer's time over ours; None where the row only reports.
ROWS = [
    ("fields", "numpy_by_hand", "fields.whole", None),
    ("fields", "numpy_by_hand", "fields.blocks", 5.0),
    ("fields", "sdfcad", "fields.whole", 15.0),
    ("fields", "sdfcad", "fields.blocks", None),
    ("fields.one", "sdfcad", "fields.one", None),
    ("fields", "peclet", "fields", 40.0),
    ("fields.gradient", "peclet", "fields.gradient", None),
    ("fields.one", "peclet", "fields.one", None),
    ("fields", "jax", "fields", 1.0),
    ("fields", "jax", "fields.inside", None),
    ("fields.f32", "jax", "fields.f32", None),
    ("fields.gradient", "jax", "fields.gradient", 3.0),
    ("fields.one", "jax", "fields.one", None),
    ("mesh", "trimesh", "mesh", None),
    ("mesh", "libigl", "mesh.pseudonormal", None),
    ("mesh", "libigl", "mesh.winding", None),
    ("mesh", "open3d", "mesh", None),
    ("box.overlap", "coal", "box.overlap", None),
    # A third of its speed: the distance of two convex bodies is what its algorithm is made for.
    ("box.separation", "coal", "box.separation", 1 / 3),
    ("plate.overlap", "coal", "plate.overlap", None),
    ("plate.separation", "coal", "plate.separation", None),
    ("box.separation", "mujoco", "box.separation", None),
]

#: The longest time of one point that is asked for itself [s].
ONE_POINT = 0.5e-6


def plate(sides: int = 128) -> tuple[np.ndarray, np.ndarray]:
    """A plate of 0.2 × 0.1 × 0.2 m with a round hole of 0.06 m, as triangles: off the circle by 0.02 mm at most."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    square = 0.1 * ring / np.abs(ring).max(axis=1, keepdims=True)
    rings = [(square, 0.05), (0.06 * ring, 0.05), (0.06 * ring, -0.05), (square, -0.05)]
    corners = [np.insert(flat, 1, height, axis=1) for flat, height in rings]
    faces = []
    for k in range(4):
        for i in range(sides):
            a, b = sides * k + i, sides * k + (i + 1) % sides
            c, d = (a + sides) % (4 * sides), (b + sides) % (4 * sides)
            faces += [[a, b, d], [a, d, c]]
    return np.concatenate(corners), np.array(faces)


def question(points: int, near: int, poses: int) -> dict[str, np.ndarray]:
    """What all are asked, the same in each run."""
    random = np.random.default_rng(7)
    solid = (pp.cuboid([0.6, 0.4, 0.6]) & pp.ball(0.35)) - pp.cylinder(radius=0.1, height=1.0)
    mesh = solid.mesh(cell=0.02)
    plate_vertices, plate_faces = plate()
    turns = random.normal(size=(poses, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    ways = random.uniform(-0.2, 0.2, (poses, 3))
    return {
        "points": random.uniform(-0.5, 0.5, (points, 3)),
        "near": random.uniform(-0.4, 0.4, (near, 3)),
        "poses": np.concatenate([ways, turns], axis=1),
        "vertices": mesh.vertices,
        "faces": mesh.faces.astype(np.int64),
        "plate_vertices": plate_vertices,
        "plate_faces": plate_faces,
    }


def environment(name: str) -> str | None:
    """The interpreter of a peer; None, and a sentence that says why, if it cannot be installed."""
    folder = FOLDER / name
    python = folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    wanted = "\n".join(PEERS[name])
    made = folder / "made"
    if not (made.exists() and made.read_text() == wanted):
        print(f"installing {name} …", file=sys.stderr)
        venv.create(folder, with_pip=True, clear=True)
        command = [python, "-m", "pip", "install", "--quiet", "--only-binary", ":all:"]
        done = subprocess.run([*command, *PEERS[name]], capture_output=True, text=True)
        if done.returncode != 0:
            why = done.stderr.strip().splitlines()[-1:]
            print(f"{name} is left out: {' '.join(why)}", file=sys.stderr)
            return None
        made.write_text(wanted)
    return str(python)


def ask(name: str, python: str, asked: Path) -> dict[str, np.ndarray] | None:
    answered = FOLDER / f"{name}.npz"
    command = [python, str(HERE / "peers.py"), name, str(asked), str(answered)]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        why = done.stderr.strip().splitlines()[-1:]
        print(f"{name} is left out: {' '.join(why)}", file=sys.stderr)
        return None
    with np.load(answered) as answer:
        return dict(answer)


def ask_ourselves(asked: Path) -> dict[str, np.ndarray]:
    answer = ask("palpate", sys.executable, asked)
    if answer is None:
        raise SystemExit("palpate itself gave no answer")
    return answer


def differ(key: str, ours: np.ndarray, theirs: np.ndarray) -> dict[str, float]:
    """How far the values of a peer are from ours."""
    ours = ours[: len(theirs)]
    if key.endswith("overlap"):
        return {"differ": float(np.mean(ours != theirs))}
    if key.endswith("separation"):
        # Where bodies overlap, a peer may tell another depth, or none.
        apart = (ours > 1e-4) & (theirs > 1e-4)
        largest = np.abs(ours - theirs)[apart].max(initial=0.0)
        return {"differ_m": float(largest), "differ": float(np.mean((ours > 0) != (theirs > 0)))}
    return {
        "differ_m": float(np.abs(ours - theirs).max()),
        "signs_differ": float(np.mean((ours < 0) != (theirs < 0))),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", help="names of peers, separated by commas")
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--near", type=int, default=20_000, help="points of the mesh")
    parser.add_argument("--poses", type=int, default=5000)
    parser.add_argument("--json", type=Path, help="writes the numbers to a file")
    options = parser.parse_args()
    chosen = options.only.split(",") if options.only else list(PEERS)
    unknown = [name for name in chosen if name not in PEERS]
    if unknown:
        parser.error(f"unknown peers {', '.join(unknown)}: there are {', '.join(PEERS)}")

    FOLDER.mkdir(parents=True, exist_ok=True)
    asked = FOLDER / "question.npz"
    counts = {"fields": options.points, "mesh": options.near}
    np.savez(asked, **question(options.points, options.near, options.poses))
    ours = ask_ourselves(asked)
    table = Table()

    def count(key: str) -> int:
        return 1 if key.endswith("one") else counts.get(key.split(".")[0], options.poses)

    for key in [key for key in ours if key.endswith(".seconds")]:
        short = key.removesuffix(".seconds")
        table.report(f"{short}.palpate.ns", 1e9 * float(ours[key]) / count(short))
    table.at_most("fields.one.palpate.ns", 1e9 * ONE_POINT)
    for name in chosen:
        python = environment(name)
        for _, peer, key, bar in ROWS:
            if peer == name and bar is not None:
                table.at_least(f"{key}.{name}_over_palpate", bar)
        theirs = ask(name, python, asked) if python else None
        if theirs is None:
            continue
        before, ours = ours, ask_ourselves(asked)
        for own, peer, key, _ in ROWS:
            if peer != name:
                continue
            seconds = float(theirs[f"{key}.seconds"])
            table.report(f"{key}.{name}.ns", 1e9 * seconds / count(key))
            if f"{key}.values" in theirs and f"{own}.values" in ours:
                found = differ(own, ours[f"{own}.values"], theirs[f"{key}.values"])
                for what, value in found.items():
                    table.report(f"{key}.{name}.{what}", value)
            ratio = f"{key}.{name}_over_palpate"
            table.report(ratio, seconds / min(float(run[f"{own}.seconds"]) for run in (before, ours)))
    return table.end(options.json)


if __name__ == "__main__":
    raise SystemExit(main())
