"""The bridges in examples/ that send gaze of trackers which tomcom does not know: run as they are, with a device that is none. Neon's gaze
is mapped to the display by Pupil's own packages, in pictures of a scene camera with the display's tags; Tobii's data are as its SDK's
reference says. Both send to a live session, Tobii's from an address of the network, paired.

    tests/outside/bridges.py TOMCOM FOLDER [neon tobii mapping]
"""

import json
import os
import re
import socket
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from console import Console, recorded, verify
from page import plain
from scene_camera import CAMERA, DISTORTION, Pose, screen

HERE, EXAMPLES = Path(__file__).parent, Path("examples")
LAYOUT = Path("layouts/sushi.toml")
PORT = 20640
# How the display lies before the participant, and where on it the gaze is.
POSES = [Pose(0, 0, 0, 2.0), Pose(25, -8, 4, 1.9, (0.1, 0.05)), Pose(-30, 5, -6, 2.1, (-0.15, 0.0)), Pose(10, 12, 15, 2.3, (0.0, -0.1))]
POINTS = [(0.5, 0.5), (0.08, 0.5), (0.93, 0.55), (0.3, 0.07), (0.7, 0.94), (0.21, 0.33), (0.97, 0.97)]
# The share of the display by which mapped gaze may be wrong.
RIGHT = 0.01


def kitchen(tomcom):
    done = subprocess.run([tomcom, "kitchen", LAYOUT, "--format", "json"], capture_output=True, check=True)
    return json.loads(done.stdout)


def check_mapping(tomcom, _):
    """Gaze at known places of the display, mapped by the bridge's own function with Pupil's own code."""
    sys.path.insert(0, str(EXAMPLES))
    from neon_bridge import DisplayMapper, tag_corners
    from pupil_labs.realtime_api.streaming.gaze import GazeData

    told = kitchen(tomcom)
    display = screen(told)
    mapper = DisplayMapper({"scene_camera_matrix": CAMERA, "scene_distortion_coefficients": DISTORTION}, tag_corners(told))
    worst = 0.0
    for number, pose in enumerate(POSES):
        picture = pose.picture(display, seed=9771 + number)
        for point, (x, y) in zip(POINTS, pose.in_picture(POINTS)):
            found = mapper.point(picture, GazeData(float(x), float(y), True, 0.0))
            assert found is not None, f"the tags are not found in picture {number}"
            worst = max(worst, *(abs(a - b) for a, b in zip(found, point)))
        assert mapper.point(picture, GazeData(800.0, 600.0, False, 0.0)) is None, "glasses that are not worn see nothing"
    assert mapper.point(np.full_like(picture, 60), GazeData(800.0, 600.0, True, 0.0)) is None, "no tags, no gaze on the display"
    assert worst < RIGHT, worst
    print(f"Neon's gaze mapped by Pupil's own code: {len(POSES) * len(POINTS)} looks, wrong by {100 * worst:.2f} % of the display at most", flush=True)


@contextmanager
def operate(tomcom, folder, port, more=""):
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "session.toml"
    path.write_text(
        f'layout = "{LAYOUT.resolve()}"\n[participant]\nkind = "keyboard"\ngaze = "json"\ngaze_port = {port}\n{more}'
        "[trial]\npresses = 100000\nseconds = 86400.0\n"
    )
    with Console(tomcom, [path, "--out", folder / "recordings"]) as console:
        console.wait_for("READY")
        yield console


@contextmanager
def bridge(name, arguments, log, environment):
    command = [sys.executable, EXAMPLES / f"{name}_bridge.py", *arguments]
    with open(log, "w") as output:
        process = subprocess.Popen([str(part) for part in command], stdout=output, stderr=output, env={**os.environ, **environment})
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def gaze_of(tomcom, folder):
    (recording,) = (folder / "recordings").iterdir()
    verify(tomcom, recording)
    return recorded(recording, "gaze")


def spread_ms(gaze):
    """By how much session time less the tracker's own time varies, without the twentieth that this machine held up longest."""
    ahead = sorted((event["taken_ns"] - event["device_ns"]) / 1e6 for event in gaze)
    return ahead[len(ahead) * 95 // 100] - ahead[0]


def check_neon(tomcom, folder):
    folder.mkdir(parents=True, exist_ok=True)
    display = screen(kitchen(tomcom))
    pictures = [pose.picture(display, seed=9775 + number) for number, pose in enumerate(POSES[:2])]
    pictures.append(np.full_like(pictures[0], 60))
    # Every second another one: places in two pictures, no tags, glasses that are not worn.
    looks = [(0, POINTS[0], True), (0, POINTS[3], True), (1, POINTS[2], True), (2, POINTS[0], True), (1, POINTS[5], False)]
    pixels = [POSES[number % 2].in_picture(point)[0] for number, point, _ in looks]
    np.savez(
        folder / "frames.npz", pictures=np.array(pictures), picture=[look[0] for look in looks], gaze=np.array(pixels),
        worn=[look[2] for look in looks], camera=CAMERA, distortion=DISTORTION,
    )
    began = time.time()
    environment = {"PYTHONPATH": str(HERE / "trackers/neon"), "NEON_FRAMES": str(folder / "frames.npz"), "NEON_BEGAN": str(began)}
    arguments = [LAYOUT, "--tomcom", tomcom, "--to", f"127.0.0.1:{PORT}"]
    with operate(tomcom, folder, PORT) as console, bridge("neon", arguments, folder / "bridge.txt", environment) as sender:
        console.wait_for("gaze +[0-9]+ Hz", 60)
        time.sleep(12)
        assert sender.poll() is None, (folder / "bridge.txt").read_text()
        console.quit()
    gaze = gaze_of(tomcom, folder)
    kinds, worst = [0, 0], 0.0
    for event in gaze:
        # The phone's clock is 4.2 s behind.
        number = round((event["device_ns"] / 1e9 + 4.2 - began) * 30)
        picture, point, is_worn = looks[number // 30 % len(looks)]
        is_known = picture < 2 and is_worn
        assert (event["confidence"] == 1) == is_known and event["confidence"] in (0, 1), (event, number)
        kinds[is_known] += 1
        if is_known:
            worst = max(worst, abs(event["x"] - point[0]), abs(event["y"] - point[1]))
    late_ms = [(event["t_ns"] - event["taken_ns"]) / 1e6 for event in gaze[30:]]
    assert min(kinds) > 10 and worst < RIGHT, (kinds, worst)
    # A picture takes 150 ms to this computer; stamps are right all the same.
    assert min(late_ms) > 148 and spread_ms(gaze[30:]) < 5, (min(late_ms), spread_ms(gaze[30:]))
    rate = len(gaze) / ((gaze[-1]["t_ns"] - gaze[0]["t_ns"]) / 1e9)
    print(
        f"the Neon bridge: {kinds[1]} samples at {rate:.0f} Hz wrong by {100 * worst:.2f} % at most, {kinds[0]} without tags or glasses at "
        f"confidence 0; {min(late_ms):.0f} ms on the way and more, stamps alike to {spread_ms(gaze[30:]):.1f} ms; it verifies", flush=True)


def outer_address():
    """An address of this machine by which other computers would reach it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(("192.0.2.1", 9))
        return probe.getsockname()[0]


def check_tobii(tomcom, folder):
    sys.path.insert(0, str(HERE / "trackers/tobii"))
    import tobii_research

    environment, log = {"PYTHONPATH": str(HERE / "trackers/tobii")}, folder / "bridge.txt"
    to = f"{outer_address()}:{PORT + 1}"
    with operate(tomcom, folder, PORT + 1, 'gaze_listen = "0.0.0.0"\n') as console:
        console.key("\x06")
        console.wait_for(r"gaze pairing +pairing code [A-Z0-9]{6}")
        shown = plain(console.text())
        assert to in shown, f"{to}:\n{shown}"
        code = re.search(r"pairing code ([A-Z0-9]{6})", shown)[1]
        console.key("\x1b")
        console.wait_for(rf"gaze sender +pairing code {code}")
        for wrong, told in ((["--pair", "WRONG2"], "does not take the pairing code WRONG2"), ([], "it wants --pair CODE")):
            with bridge("tobii", ["--to", to, *wrong], log, environment) as sender:
                if wrong:
                    sender.wait(20)
                else:
                    console.wait_for("rejected: its first line is not the pairing code", 20)
                    time.sleep(2)
            assert told in log.read_text(), log.read_text()
        console.wait_for("rejected")
        time.sleep(1.1)
        with bridge("tobii", ["--to", to, "--pair", code.lower()], log, environment) as sender:
            console.wait_for("gaze +1[12][0-9] Hz", 20)
            time.sleep(6)
            assert sender.poll() is None, log.read_text()
            console.quit()
    gaze = gaze_of(tomcom, folder)
    parts, worst = [0] * 4, 0.0
    first = gaze[0]["device_ns"]
    number = {event["device_ns"]: round((event["device_ns"] - first) / 1e9 * tobii_research.HZ) for event in gaze}
    # Where in its circle the gaze was when the first sample arrived.
    begun = next(
        start for start in range(tobii_research.HZ)
        if all(expected(start + number[event["device_ns"]])[2] == (event["confidence"] == 1) for event in gaze)
    )
    for event in gaze:
        x, y, is_known, part = expected(begun + number[event["device_ns"]])
        parts[part] += 1
        if is_known:
            worst = max(worst, abs(event["x"] - x), abs(event["y"] - y))
    late_ms = [(event["t_ns"] - event["taken_ns"]) / 1e6 for event in gaze]
    assert min(parts) > 50 and worst < 1e-4, (parts, worst)
    assert min(late_ms) > 7 and spread_ms(gaze) < 5, (min(late_ms), spread_ms(gaze))
    print(
        f"the Tobii bridge, paired from {to.split(':')[0]}: {parts[0]} samples of both eyes, {parts[1] + parts[2]} of one, {parts[3]} of none, as they "
        f"were; stamps alike to {spread_ms(gaze):.1f} ms; a wrong code and no code were rejected; it verifies", flush=True)


def expected(index):
    """Where the gaze is in the nth datum, and whether it is known: from both eyes, the right one, the left one, none."""
    part = index % 120 // 30
    angle = 2 * np.pi * index / 120
    return 0.5 + 0.3 * np.cos(angle) + (0.0, 0.02, -0.02, 0.0)[part], 0.5 + 0.25 * np.sin(angle), part < 3, part


CHECKS = {"mapping": check_mapping, "neon": check_neon, "tobii": check_tobii}


if __name__ == "__main__":
    program, scratch, *names = sys.argv[1:]
    for name in names or CHECKS:
        CHECKS[name](str(Path(program).resolve()), Path(scratch).resolve() / name)
