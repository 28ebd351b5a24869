# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Touch: the servo's thread, the virtual clock, a driver in Python."""

from __future__ import annotations

import gc
import json
import os
import subprocess
import sys
import threading
import time
import wave
from pathlib import Path

import numpy as np
import palpate as pp
import pyarrow as pa
import pytest

SCENE = pp.Scene({"ball": pp.ball(0.05), "table": pp.cuboid([1, 0.1, 1]).translated([0, -0.2, 0])})
PATH = [[0, 0, 0.06, 0], [0.1, 0, 0.045, 0], [0.2, 0.01, 0.045, 0], [0.3, 0, 0.06, 0]]


def test_a_feel_is_the_same_every_time() -> None:
    one, two = [pp.feel(SCENE, hand=PATH, duration=0.3) for _ in range(2)]
    for name in ["time", "device", "proxy", "force", "contact", "evaluations"]:
        assert np.array_equal(getattr(one.trace, name), getattr(two.trace, name))
    assert len(one.trace) == 300 and one.trace.lost == 0
    assert one.trace.force[:, 1].max() > 0.1 and not one.trace.contact[0]
    # The proxy never enters a body.
    assert SCENE.whole.distance(one.trace.proxy).min() > -1e-6


def test_a_feel_is_that_of_the_program(tmp_path: Path) -> None:
    file, path, trace = tmp_path / "scene.json", tmp_path / "hand.csv", tmp_path / "trace.csv"
    SCENE.save(file)
    path.write_text("time_s,x_m,y_m,z_m\n" + "".join(f"{t},{x},{y},{z}\n" for t, x, y, z in PATH), encoding="utf-8")
    command = [sys.executable, "-m", "palpate", "feel", str(file), "--fast", "--path", str(path), "--device", "simulated:omega"]
    command += ["--duration", "0.3", "--trace", str(trace), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = np.genfromtxt(trace, delimiter=",", names=True)
    force = pp.feel(SCENE, hand=PATH, duration=0.3).trace.force
    assert np.array_equal(np.stack([rows[f"force_{axis}_n"] for axis in "xyz"], axis=1), force)
    assert json.loads(done.stdout)["ticks"] == 300


def test_a_servo_has_events_snapshots_and_a_trace() -> None:
    with pp.Servo(SCENE, hand=PATH, duration=0.3) as servo:
        kinds = [event.kind for event in servo.events()]
        assert servo.has_ended
    assert kinds[0] == "touch" and "leave" in kinds
    assert servo.report["ticks"] == 300 and len(servo.trace) == 300
    frame = pa.table(servo.trace.columns())
    assert frame.num_rows == 300 and "force_y" in frame.column_names


def test_a_scene_says_where_bodies_are_and_how_they_feel() -> None:
    down = [[0, 0, 0.08, 0], [0.3, 0, 0.045, 0]]

    def pressed(**how: object) -> float:
        scene = pp.Scene({"ball": pp.ball(0.05)}, **how)
        assert pp.Scene.from_json(scene.to_json()) == scene
        return float(pp.feel(scene, hand=down, duration=0.3).trace.force[-1, 1])

    soft, hard = [pressed(materials={"ball": {"stiffness": np.float64(k)}}) for k in (100, 1000)]
    assert 0 < soft < hard
    assert pressed(materials={"ball": "rubber"}) > 0
    assert pressed(poses={"ball": [0, -0.1, 0]}) == 0
    assert pressed(tool={"radius": 0.008, "max_force": 0.5}) == pytest.approx(0.5, abs=1e-3)
    # A guide pulls where no body is.
    far = pp.Scene(pp.ball(0.05), guides=[{"point": np.array([0.02, 0.08, 0]), "stiffness": 100}])
    assert pp.feel(far, hand=[0, 0.08, 0], duration=0.2).trace.force[-1, 0] > 0.2
    # A body that moves comes to the hand.
    comes = [{"body": "body", "to": {"translation": [0, 0.03, 0]}, "duration": 0.2}]
    assert pp.feel(pp.Scene(pp.ball(0.05), motions=comes), hand=[0, 0.06, 0], duration=0.3).trace.contact[-1]
    for how, error, words in [
        ({"materials": {"cup": "rubber"}}, KeyError, "no body is called 'cup': there are ball"),
        ({"materials": {"ball": {"hardness": 3}}}, pp.SceneError, "hardness"),
        ({"poses": {"cup": [0, 0, 0]}}, KeyError, "cup"),
        ({"tool": {"radius": -1.0}}, pp.SceneError, "tool.radius"),
        ({"tool": {"radius": object()}}, TypeError, "got a object"),
        ({"guides": [{"points": 1}]}, pp.SceneError, "guides[0]"),
    ]:
        with pytest.raises(error) as caught:
            pp.Scene({"ball": pp.ball(0.05)}, **how)
        assert words in str(caught.value)


def test_tools_have_points_and_shapes() -> None:
    fork = pp.Scene(pp.ball(0.05), tool={"points": [[-0.01, 0, 0], [0.01, 0, 0]], "radius": 0.002})
    felt = pp.feel(fork, hand=[[0, 0, 0.08, 0], [0.3, 0, 0.045, 0]], duration=0.3)
    assert len(felt.trace) == 600 and set(felt.trace.point) == {0, 1}
    left, right = [felt.trace.force[felt.trace.point == point][-1] for point in (0, 1)]
    assert left[1] > 0 and left[1] == pytest.approx(right[1]) and left[0] == pytest.approx(-right[0])
    # One path for each point leads them as one that carries them.
    apart = np.array([[[0, x, 0.08, 0], [0.3, x, 0.045, 0]] for x in (-0.01, 0.01)])
    assert np.array_equal(pp.feel(fork, hand=apart, duration=0.3).trace.force, felt.trace.force)
    assert len(pp.feel(fork, duration=0.1).trace) == 200
    peg = {"shape": pp.capsule(0.004, 0.03)}
    held = pp.feel(pp.Scene(pp.ball(0.05), tool=peg), hand=[[0, 0, 0.08, 0], [0.3, 0, 0.045, 0]], duration=0.3)
    assert held.trace.force[-1, 1] > 0 and len(held.trace) == 300
    tool = held.trace.tool
    assert tool is not None and tool.pose.shape == (300, 4, 4)
    # The tool stays on the ball, and its contacts push.
    assert np.array_equal(tool.pose[:, :3, 3], held.trace.proxy) and np.max(tool.contacts) > 0
    assert {"torque_z", "given_torque_x", "pose_03", "taken"} <= set(held.trace.columns())
    assert held.trace.taken[-1] > 0 and not held.trace.is_lifted.any()
    assert len(pp.feel(pp.Scene(pp.ball(0.05), tool=peg), duration=0.1).trace) == 100
    # Without a tool, points follow each other.
    assert set(pp.feel(pp.ball(0.05), points=3, duration=0.1).trace.point) == {0, 1, 2}
    assert set(pp.feel(pp.ball(0.05), hand=apart, duration=0.1).trace.point) == {0, 1}
    with pytest.raises(ValueError, match="give one path, which carries the tool, or 2"):
        pp.feel(fork, hand=apart[:1])
    with pytest.raises(ValueError, match="points= is about the tour"):
        pp.feel(pp.ball(0.05), hand=[0, 0.06, 0], points=2)
    with pytest.raises(ValueError, match="contact point"):
        pp.feel(pp.ball(0.05), points=0)


def test_ticks_are_kept_for_a_duration_or_as_long_as_is_said() -> None:
    with pp.Servo(SCENE, hand=[0, 0.06, 0], duration=0.05, record=0.02) as servo:
        servo.wait()
    assert len(servo.trace) == 20 and servo.trace.lost == 30
    with pp.Servo(SCENE, hand=[0, 0.06, 0]) as servo:
        pass
    with pytest.raises(RuntimeError, match="by record="):
        _ = servo.trace


def test_a_servo_that_is_asked_while_another_thread_reads_it_goes_on() -> None:
    # The stage was locked while Python ran: a thread that waited for it with the interpreter's lock stopped all.
    with pp.Servo(SCENE, hand=PATH, duration=0.5) as servo:

        def ask() -> None:
            while not servo.has_ended:
                servo.latest()
                servo.take_events()
                servo.limit_force(1.0)
                servo.set_poses({"ball": [0, 0, 0]})

        threads = [threading.Thread(target=ask, daemon=True) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
        assert not any(thread.is_alive() for thread in threads)


def test_the_last_events_outlive_the_thread() -> None:
    with pp.Servo(SCENE, hand=[0, 0.049, 0], duration=0.05) as servo:
        servo.wait()
        servo.end()
        assert "touch" in [event.kind for event in servo.events()]
        assert servo.take_events() == []
    with pytest.raises(RuntimeError, match="the servo has ended"):
        servo.stop()


def test_two_threads_may_end_a_servo() -> None:
    with pp.Servo(SCENE, hand=[0, 0.06, 0]) as servo:
        threads = [threading.Thread(target=servo.end) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
            assert servo.has_ended and servo.report["ticks"] >= 0


def test_devices_are_listed() -> None:
    for name, profile in pp.device_profiles().items():
        assert profile["max_force"] >= 0
        assert len(pp.feel(SCENE, device=name, hand=[0, 0.06, 0], duration=0.002, rate=1000).trace) == 2


def test_bodies_move_and_forces_are_limited() -> None:
    with pp.Servo(SCENE, hand=[0, 0.06, 0]) as servo:
        servo.set_poses({"ball": [0, 0.012, 0]})
        until = time.monotonic() + 30
        while not any(event.body == "ball" for event in servo.take_events()):
            assert time.monotonic() < until, "the ball that moved up was not felt"
            time.sleep(0.001)
        servo.limit_force(0.0)
        servo.stop()
        while not (now := servo.latest()) or not now.is_stopped:
            assert time.monotonic() < until
            time.sleep(0.001)
        servo.release()
        with pytest.raises(KeyError, match="there are ball, table"):
            servo.set_poses({"bal": [0, 0, 0]})
        with pytest.raises(pp.Error):
            servo.limit_force(-1.0)
    assert servo.latest() is None


def test_an_exception_ends_the_servo() -> None:
    with pytest.raises(ZeroDivisionError), pp.Servo(SCENE, hand=[0, 0.06, 0]) as servo:
        1 / 0
    assert servo.has_ended and servo.report["ticks"] >= 0
    with pytest.raises(RuntimeError, match="a servo runs once"), servo:
        pass


def test_a_servo_that_is_forgotten_ends() -> None:
    before = threading.active_count()
    pp.Servo(SCENE, hand=[0, 0.06, 0]).__enter__()
    gc.collect()
    assert threading.active_count() == before


def test_a_driver_in_python_is_felt() -> None:
    mailbox = pp.Mailbox("omega")
    with pp.Servo(SCENE, device=mailbox) as servo:
        until = time.monotonic() + 30
        while mailbox.ticks < 200 and time.monotonic() < until:
            mailbox.set([[0, 0.0, 0]])
            time.sleep(0.0005)
    assert servo.report["ticks"] >= 199
    with pytest.raises(RuntimeError, match="one servo"):
        pp.Servo(SCENE, device=mailbox)
    with pytest.raises(ValueError, match=r"positions must have the shape \(points, 3\)"):
        mailbox.set([0, 0, 0])
    with pytest.raises(TypeError, match="the scene is 3D, the mailbox 2D"):
        pp.Servo(SCENE, device=pp.Mailbox(dimension=2))


def test_a_vibration_of_ten_channels_is_read_by_wave(tmp_path: Path) -> None:
    file, sound = tmp_path / "scene.json", tmp_path / "glove.wav"
    SCENE.save(file)
    command = [sys.executable, "-m", "palpate", "feel", str(file), "--fast", "--duration", "0.1", "--device", "glove"]
    done = subprocess.run([*command, "--points", "10", "--wav", str(sound)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with wave.open(str(sound), "rb") as read:
        assert (read.getnchannels(), read.getsampwidth(), read.getframerate(), read.getnframes()) == (10, 2, 8000, 800)


def driven(mailbox: pp.Mailbox, hertz: float, seconds: float, **settings: float) -> tuple[pp.Servo, float]:
    """A driver that goes 4 mm into a plate, and the force on it at the end."""
    plate = pp.Scene(
        {"plate": pp.cuboid([0.1, 0.02, 0.1])},
        materials={"plate": {"stiffness": 800, "damping": 1}},
        tool={"workspace": {"scale": 1}},
    )
    servo, start = pp.Servo(plate, device=mailbox, record=seconds + 1, **settings), time.perf_counter()
    with servo:
        for n in range(int(seconds * hertz)):
            mailbox.set([[0, max(0.014 - 0.02 * n / hertz, 0.010), 0]], time=n / hertz)
            time.sleep(max(0, start + (n + 1) / hertz - time.perf_counter()))
        force = float(mailbox.forces[0][1])
    return servo, force


@pytest.mark.parametrize("hertz", [12, 30, 60, 90, 250])
def test_a_slow_driver_is_felt_as_its_rate_allows_or_told(hertz: int) -> None:
    servo, force = driven(mailbox := pp.Mailbox(rate=hertz), hertz, 1.5)
    assert mailbox.rate == hertz and servo.report["rate"] == hertz
    # The omega is passive up to 2 b / T of its damping; 2 mm of the probe are in the plate.
    assert force > 0.0005 * 2 * hertz, force
    with pytest.raises(pp.DeviceLostError, match=r"states a second, but the servo takes .*, and would give no force.*rate="):
        driven(pp.Mailbox(), hertz, 1.5)


def test_a_servo_faster_than_its_mailbox_is_refused() -> None:
    with pytest.raises(pp.HapticsError, match="measures 90 times a second, but the servo ticks 1000 times"):
        driven(pp.Mailbox(rate=90), 90, 0.1, rate=1000.0)
    with pytest.raises(ValueError, match="rate must be positive and finite, got -5 Hz"):
        pp.Mailbox(rate=-5)


def test_python_that_holds_its_lock_delays_no_tick() -> None:
    with pp.Servo(SCENE, hand=[0, 0.06, 0], duration=0.3) as servo:
        until = time.monotonic() + 0.25
        while time.monotonic() < until:
            sum(range(2_000_000))
        list(servo.events())
    # All ticks were made, though Python was busy all the time.
    assert servo.report["ticks"] == 300


def test_in_the_plane() -> None:
    scene = pp.Scene(pp.ball(0.05, dimension=2))
    felt = pp.feel(scene, hand=[[0, 0, 0.06], [0.1, 0, 0.045]], duration=0.1)
    assert felt.trace.force.shape == (100, 2) and felt.trace.force[-1, 1] > 0
    tour = pp.feel(scene, duration=0.5)
    assert tour.trace.contact.any()


def test_what_cannot_be_touched_is_refused() -> None:
    for make, error, words in [
        (lambda: pp.Servo(SCENE, device="omeg"), pp.UnknownNameError, "omeg"),
        (lambda: pp.Servo(SCENE, device=3), TypeError, "the name of a profile or a Mailbox"),
        (lambda: pp.Servo(SCENE, hand=[0, 0]), ValueError, "hand must have the shape (3,), or (n, 4) or (points, n, 4) with times first"),
        (lambda: pp.Servo(SCENE, hand=[0, np.nan, 0]), pp.Error, ""),
        (lambda: pp.Servo(SCENE, record=-1.0), ValueError, "are kept for 0 s to 10000 s, got -1 s"),
        (lambda: pp.Servo(SCENE, record=1e9), ValueError, "ticks of 1 contact points at 1000 Hz are kept"),
        (lambda: pp.Servo(SCENE, device=pp.Mailbox(), hand=[0, 0, 0]), TypeError, "a Mailbox sets its own positions"),
        (lambda: pp.Mailbox(points=2**60), ValueError, "points must be 1 to 1000"),
        (lambda: pp.feel(SCENE, points=10**12), ValueError, "points must be 1 to 1000"),
        (lambda: pp.Servo(SCENE, rate=-5.0), ValueError, "rate must be positive and finite, got -5 Hz"),
        (lambda: pp.feel(SCENE, rate=float("nan"), duration=1.0), ValueError, "rate must be positive and finite"),
        (lambda: pp.feel(SCENE, points=1000, duration=9000.0), ValueError, "ticks of 1000 contact points"),
        (lambda: pp.Mailbox().set([[0, np.nan, 0]]), ValueError, "positions[0, 1] must be finite, got NaN m"),
        (lambda: pp.Scene({"a": 5}), TypeError, 'the body "a" must be a Shape, got a int'),
        (lambda: pp.Scene({"a": pp.ball(1)}, materials="rubber"), TypeError, "a dict of the names of bodies"),
        (lambda: pp.feel(SCENE, duration=-1.0), ValueError, "duration must be 0.0005 s to 1000000 s at 1000 Hz, got -1 s"),
        (lambda: pp.Servo(pp.Scene(pp.half_space([0, 1, 0], 0.0))), ValueError, "no body has bounds"),
    ]:
        with pytest.raises(error) as caught:
            make()
        assert words in str(caught.value)


def test_what_does_not_run_is_not_waited_for() -> None:
    servo = pp.Servo(pp.ball(0.05), hand=[0, 0.049, 0], duration=0.05)
    for ask in (servo.events, servo.wait):
        with pytest.raises(RuntimeError, match="has not begun: use it in a with statement"):
            ask()
    with servo:
        assert servo.wait() and servo.has_ended
    assert servo.report["ticks"] == 50


def test_a_virtual_clock_refuses_a_mailbox_in_words() -> None:
    with pytest.raises(TypeError, match="give a Mailbox to Servo"):
        pp.feel(pp.ball(0.05), device=pp.Mailbox(), duration=0.01)


def test_a_servo_that_is_refused_leaves_the_mailbox() -> None:
    # It took the mailbox before it looked at the other settings.
    mailbox = pp.Mailbox()
    for wrong in ({"rate": 0.0}, {"record": -1.0}, {"duration": -1.0}, {"hand": [0, 0, 0]}):
        with pytest.raises((TypeError, ValueError)):
            pp.Servo(SCENE, device=mailbox, **wrong)
    pp.Servo(SCENE, device=mailbox)


def test_a_device_that_is_lost_is_told() -> None:
    # The block ended as if nothing had happened.
    mailbox = pp.Mailbox()
    with pytest.raises(pp.DeviceLostError, match="the device was lost"), pp.Servo(SCENE, device=mailbox, record=1.0) as servo:
        mailbox.set([[0, 0.06, 0]])
        mailbox.lose()
        servo.wait()
    assert servo.report["ending"]["kind"] == "device_lost"
    # What the block raises says more.
    mailbox = pp.Mailbox()
    with pytest.raises(ZeroDivisionError), pp.Servo(SCENE, device=mailbox) as servo:
        mailbox.lose()
        servo.wait()
        1 / 0


def test_a_servo_that_ended_by_itself_has_its_report_in_the_block() -> None:
    with pp.Servo(SCENE, hand=[0, 0.06, 0], duration=0.02) as servo:
        with pytest.raises(RuntimeError, match="has not ended"):
            _ = servo.report
        servo.wait()
        assert servo.report["ticks"] == 20 and len(servo.trace) == 20 and servo.latest() is None
    # Left out, `record` is what fits: 10 million rows.
    pp.Servo(SCENE, points=20, duration=600.0)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork on this system")
def test_a_child_has_no_servo() -> None:
    # It panicked, or waited for a thread that it does not have.
    program = """
import os, gc, palpate as pp
with pp.Servo(pp.ball(0.05), hand=[0, 0.049, 0], duration=0.5) as servo:
    child = os.fork()
    if child == 0:
        said = []
        for ask in (servo.latest, servo.wait, servo.stop, lambda: servo.report):
            try:
                said.append(ask())
            except RuntimeError as error:
                said.append(str(error))
        assert said == [None] + 3 * ["the servo runs in the process that forked this one"], said
        assert servo.has_ended and servo.take_events() == []
    else:
        assert os.waitpid(child, 0)[1] == 0
        servo.wait()
if child:
    assert servo.report["ticks"] == 500
else:
    del servo
    gc.collect()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
