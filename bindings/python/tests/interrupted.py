# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Long calls that Ctrl-C ends, each in a process of its own."""

from __future__ import annotations

import subprocess
import sys

CALLS = {
    "distance": "pp.Shape.distance(many, np.zeros((3_000_000, 3)))",
    "threads": "pp.Shape.distance(many, np.zeros((3_000_000, 3)), threads=2)",
    "gradient": "pp.Shape.gradient(many, np.zeros((3_000_000, 3)))",
    "separations": "pp.separations(many, many, np.full((200_000, 3), 1.3))",
    "overlaps": "pp.overlaps(many, many, np.full((200_000, 3), 1.3), threads=2)",
    "feel": "pp.feel(pp.Scene(many), hand=[0, 0.09, 0], duration=1000.0)",
    "mesh": "many.mesh(cell=0.002)",
    "tolerance": "many.mesh(tolerance=1e-6)",
    "baked": "many.baked(cell=0.01, most_nodes=2**26)",
    "mass": "many.mass(tolerance=1e-12, cells=1_000_000_000)",
    "contacts": "pp.mesh_contacts(many, pp.ball(0.5).mesh(cell=0.01), gap=0.5, tolerance=1e-12, budget=2_000_000_000)",
    "function": "pp.separation(slow, many, tolerance=1e-9)",
    "render": "many.render(width=6000, height=4000)",
    "events": "[e for s in [pp.Servo(pp.Scene(many), hand=[0, 9, 0]).__enter__()] for e in s.events()]",
}

PROGRAM = """
import sys, time, threading, signal, os
import numpy as np
import palpate as pp
# A process whose parent ignores Ctrl-C ignores it too.
signal.signal(signal.SIGINT, signal.default_int_handler)
many = pp.union(pp.ball(0.1).translated([0.3 * x, 0.3 * y, 0.3 * z]).twisted(degrees=3)
                for x in range(6) for y in range(6) for z in range(6))
slow = pp.from_function(lambda p: (time.sleep(0.01), np.linalg.norm(p, axis=1) - 0.1)[1], lipschitz=1.0, bounds=[[-1] * 3, [1] * 3])
def interrupt():
    time.sleep(0.5)
    interrupt.at = time.perf_counter()
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
try:
    {call}
    print("the call was too short")
except KeyboardInterrupt:
    print(time.perf_counter() - interrupt.at)
"""


def delay(name: str) -> float:
    """How long after Ctrl-C a call ends [s]."""
    text = PROGRAM.format(call=CALLS[name])
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=60, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return float(done.stdout)
