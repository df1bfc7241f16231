"""Sends gaze to a live session in tmux, as another program's eye tracker would, and looks for it in the recording."""

import json
import math
import os
import random
import re
import socket
import subprocess
import sys
import time
import tomllib
from pathlib import Path

PAGE = Path("docs/tracker-json.md").read_text()
PORT = tomllib.loads(Path("sessions/default.toml").read_text())["participant"]["gaze_port"]
MALFORMED = [
    b"nonsense",
    b"[]",
    b"{}",
    b"null",
    b'{"x": 0.5, "y": 0.5}',
    b'{"x": "0.5", "y": 0.5, "confidence": 1}',
    b'{"x": NaN, "y": 0.5, "confidence": 1}',
    b'{"x": 1e999, "y": 0.5, "confidence": 1}',
    b'{"x": 0.5, "y": 0.5, "confidence": 1',
    b"\xff\xfe\x00\x01",
    b"[" * 3000,
    b"9" * 20000,
]


class Console:
    """A live session in a terminal of its own."""

    def __init__(self, tomcom, out, *arguments):
        self.out = Path(out)
        self.server = f"tomcom-outside-{os.getpid()}"
        command = [tomcom, *arguments, "--participant", "keyboard", "--gaze", "json", "--out", str(out)]
        self.tmux("-f", "/dev/null", "new-session", "-d", "-x", "120", "-y", "40", *command)
        self.wait_for("READY")

    def tmux(self, *arguments):
        done = subprocess.run(["tmux", "-L", self.server, *arguments], capture_output=True, text=True)
        return done.stdout

    def screen(self):
        return self.tmux("capture-pane", "-p")

    def wait_for(self, text, seconds=20):
        until = time.monotonic() + seconds
        while not re.search(text, self.screen()):
            assert time.monotonic() < until, f"{text} did not appear:\n{self.screen()}"
            time.sleep(0.05)

    def keys(self, *keys):
        for key in keys:
            self.tmux("send-keys", key)
            time.sleep(0.1)

    def quit(self):
        """Quits and gives back the recording's folder."""
        self.keys("C-c", "y")
        until = time.monotonic() + 20
        while self.screen():
            assert time.monotonic() < until, f"the console does not end:\n{self.screen()}"
            time.sleep(0.05)
        (recording,) = self.out.iterdir()
        return recording

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.tmux("kill-server")


def recorded(recording):
    lines = (recording / "events.jsonl").read_text().splitlines()[1:]
    return [json.loads(line) for line in lines]


def verify(tomcom, recording):
    done = subprocess.run([tomcom, "replay", recording, "--verify", "--format", "json"], capture_output=True, text=True)
    assert done.returncode == 0 and json.loads(done.stdout)["verified"] is True, done


def connect():
    tracker = socket.create_connection(("127.0.0.1", PORT), timeout=10)
    tracker.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return tracker


def send_among_nonsense(console):
    """Sends 600 samples, over several connections, cut into pieces anywhere, with lines between that are none."""
    chance = random.Random(5)
    sent = []
    for part in range(3):
        tracker = connect()
        for index in range(200):
            sample = {"t": 100 + len(sent) / 120, "x": chance.uniform(-0.1, 1.1), "y": chance.random()}
            sample["confidence"] = chance.random()
            sent.append(sample)
            line = json.dumps(sample).encode() + b"\n"
            # A connection that begins with nonsense is none of a tracker.
            if index % 10 == 1:
                line = MALFORMED[(index // 10) % len(MALFORMED)] + b"\n" + line
            cut = chance.randrange(len(line))
            tracker.sendall(line[:cut])
            time.sleep(0.002)
            tracker.sendall(line[cut:])
            if part == 1 and index == 100:
                # So much nonsense is told before the trial; it is started all the same.
                console.keys(".")
                console.wait_for("gaze stream .* malformed")
                console.keys("o", "Tab", "e", "g", "v")
        # A tracker that goes in the middle of a line; the next one begins when all of it was read.
        tracker.sendall(b'{"x": 0.5, "y"')
        tracker.close()
        console.wait_for(f"{21 * (part + 1)} malformed")
    return sent


def check_sender(tomcom, scratch):
    with Console(tomcom, scratch / "sender", "operate", "sessions/default.toml") as console:
        sent = send_among_nonsense(console)
        recording = console.quit()
    events = recorded(recording)
    gaze = [event for event in events if event["kind"] == "gaze"]
    assert len(gaze) == len(sent), (len(gaze), len(sent))
    for found, sample in zip(gaze, sent):
        assert abs(found["x"] - sample["x"]) < 1e-5 and abs(found["y"] - sample["y"]) < 1e-5, (found, sample)
        assert abs(found["confidence"] - sample["confidence"]) < 1e-3, (found, sample)
        assert abs(found["device_ns"] - sample["t"] * 1e9) < 1000, (found, sample)
    pressed = [event["button"] for event in events if event["kind"] == "press" and event["agent"] == "human"]
    assert pressed == ["take rice", "cooking_pot", "cook"], pressed
    verify(tomcom, recording)
    print(f"gaze over TCP: {len(sent)} samples recorded in order among 63 malformed lines; the recording verifies")


def check_documented_sender(tomcom, scratch):
    """The sender on docs/tracker-json.md, run as it is printed."""
    senders = [code for code in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL) if str(PORT) in code]
    assert len(senders) == 1, "one sender on the page, with the default port"
    lines = [line for line in senders[0].splitlines() if line.strip()]
    assert len(lines) <= 10, f"the ten-line sender has {len(lines)} lines"
    with Console(tomcom, scratch / "documented") as console:
        sender = subprocess.Popen([sys.executable, "-c", senders[0]])
        time.sleep(3)
        assert sender.poll() is None, "the documented sender ended"
        sender.kill()
        sender.wait()
        recording = console.quit()
    gaze = [event for event in recorded(recording) if event["kind"] == "gaze"]
    seconds = (gaze[-1]["t_ns"] - gaze[0]["t_ns"]) / 1e9
    assert len(gaze) > 60 and seconds > 1, f"{len(gaze)} samples in {seconds} s"
    for sample in gaze:
        radius = math.hypot(sample["x"] - 0.5, sample["y"] - 0.5)
        assert abs(radius - 0.3) < 1e-3, f"{sample} is not on the circle"
    verify(tomcom, recording)
    print(f"the documented sender: {len(gaze)} samples in {seconds:.1f} s; the recording verifies")


def check_set_clock(tomcom, scratch):
    """A tracker whose clock is set back by 0.7 s, and that sends one stamp 0.8 s ahead, and one that is no time."""
    with Console(tomcom, scratch / "clock") as console:
        tracker = connect()
        begun = time.monotonic()
        for index in range(600):
            t = 50 + time.monotonic() - begun - (0.7 if index >= 300 else 0) + (0.8 if index == 150 else 0)
            sample = {"t": -1 if index == 200 else t, "x": 0.5, "y": 0.5, "confidence": 1}
            tracker.sendall(json.dumps(sample).encode() + b"\n")
            time.sleep(0.01)
            if index == 205:
                console.wait_for("t = -1 is no time")
        console.wait_for("clock was set back by 0\\.7")
        tracker.close()
        recording = console.quit()
    events = recorded(recording)
    (step,) = [event for event in events if event["kind"] == "tracker" and event["what"] == "clock_set"]
    assert abs(step["by_s"] + 0.7) < 0.01, step
    after = [event for event in events if event["kind"] == "gaze" and event["t_ns"] > step["t_ns"]]
    late_ms = [(event["t_ns"] - event["taken_ns"]) / 1e6 for event in after]
    uncertain_s = (step["t_ns"] - step["uncertain_since_ns"]) / 1e9
    assert len(after) > 200 and 0 <= min(late_ms) and sorted(late_ms)[len(late_ms) // 2] < 5, sorted(late_ms)
    assert uncertain_s < 1, step
    verify(tomcom, recording)
    print(f"a clock set back by 0.7 s: told after {uncertain_s:.2f} s, then {len(after)} samples on time; it verifies")


if __name__ == "__main__":
    program, folder = sys.argv[1], Path(sys.argv[2])
    check_sender(program, folder)
    check_documented_sender(program, folder)
    check_set_clock(program, folder)
