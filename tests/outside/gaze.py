"""Sends gaze to a live session in tmux, as another program's eye tracker would, and looks for it in the recording."""

import json
import math
import random
import re
import socket
import subprocess
import sys
import time
import tomllib
from pathlib import Path

from console import Console, Tmux, recorded, verify

PAGE = Path("docs/tracker-json.md").read_text()
PORT = tomllib.loads(Path("sessions/default.toml").read_text())["participant"]["gaze_port"]
MALFORMED = [
    b"nonsense",
    b"[]",
    b"{}",
    b"null",
    b'{"x": 0.5, "confidence": 1}',
    b'{"x": "0.5", "y": 0.5, "confidence": 1}',
    b'{"x": NaN, "y": 0.5, "confidence": 1}',
    b'{"x": 1e999, "y": 0.5, "confidence": 1}',
    b'{"x": 0.5, "y": 0.5, "confidence": 1',
    b"\xff\xfe\x00\x01",
    b"[" * 3000,
    b"9" * 20000,
]


def session(tomcom, out, *arguments):
    return Tmux(tomcom, out, *arguments, "--participant", "keyboard", "--gaze", "json")


def keys(console, *keys):
    for key in keys:
        console.key(key)
        time.sleep(0.1)


def checks(console, text):
    """Waits for this in the list of checks before the trial."""
    keys(console, ".")
    console.wait_for(text)
    keys(console, "Escape")


def connect():
    tracker = socket.create_connection(("127.0.0.1", PORT), timeout=10)
    tracker.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return tracker


def send_among_nonsense(console):
    """Sends 600 samples, over several connections, cut into pieces anywhere, with lines between that are none."""
    chance, begun = random.Random(5), time.monotonic()
    sent = []
    for part in range(3):
        tracker = connect()
        for index in range(200):
            sample = {"t": 100 + time.monotonic() - begun, "x": chance.uniform(-0.1, 1.1), "y": chance.random()}
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
                keys(console, ".")
                console.wait_for("gaze stream .* malformed")
                keys(console, "o", "Tab", "y", "x", "c")
        # A tracker that goes in the middle of a line; the next one begins when all of it was read.
        tracker.sendall(b'{"x": 0.5, "y"')
        tracker.close()
        console.wait_for(f"{21 * (part + 1)} malformed")
    return sent


def check_sender(tomcom, scratch):
    with session(tomcom, scratch / "sender", "operate", "sessions/default.toml") as console:
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
    with session(tomcom, scratch / "documented") as console:
        sender = subprocess.Popen([sys.executable, "-c", senders[0]])
        time.sleep(3)
        assert sender.poll() is None, "the documented sender ended"
        sender.kill()
        sender.wait()
        recording = console.quit()
    gaze = recorded(recording, "gaze")
    seconds = (gaze[-1]["t_ns"] - gaze[0]["t_ns"]) / 1e9
    assert len(gaze) > 60 and seconds > 1, f"{len(gaze)} samples in {seconds} s"
    for sample in gaze:
        radius = math.hypot(sample["x"] - 0.5, sample["y"] - 0.5)
        assert abs(radius - 0.3) < 1e-3, f"{sample} is not on the circle"
    verify(tomcom, recording)
    print(f"the documented sender: {len(gaze)} samples in {seconds:.1f} s; the recording verifies")


def check_set_clock(tomcom, scratch):
    """A tracker whose clock began before zero, is set back by 0.7 s, and that sends one stamp 0.8 s ahead, and one that is no time."""
    with session(tomcom, scratch / "clock") as console:
        tracker = connect()
        begun = time.monotonic()
        for index in range(600):
            t = -2 + time.monotonic() - begun - (0.7 if index >= 300 else 0) + (0.8 if index == 150 else 0)
            sample = {"t": 1e20 if index == 200 else t, "x": 0.5 + index / 1e4, "y": 0.5, "confidence": 1}
            tracker.sendall(json.dumps(sample).encode() + b"\n")
            time.sleep(0.01)
            if index == 205:
                console.wait_for("t = 1(0{20}) is no time")
        console.wait_for("clock was set back by 0\\.7")
        tracker.close()
        recording = console.quit()
    events = recorded(recording)
    stamps = [event["device_ns"] for event in events if event["kind"] == "gaze"]
    assert len(stamps) == 599 and min(stamps) < -1.9e9 and max(stamps) > 1e9, (len(stamps), min(stamps), max(stamps))
    (step,) = [event for event in events if event["kind"] == "tracker" and event["what"] == "clock_set"]
    assert abs(step["by_s"] + 0.7) < 0.01, step
    after = [event for event in events if event["kind"] == "gaze" and event["t_ns"] > step["t_ns"]]
    late_ms = [(event["t_ns"] - event["taken_ns"]) / 1e6 for event in after]
    uncertain_s = (step["t_ns"] - step["uncertain_since_ns"]) / 1e9
    assert len(after) > 200 and 0 <= min(late_ms) and sorted(late_ms)[len(late_ms) // 2] < 5, sorted(late_ms)
    assert uncertain_s < 1, step
    verify(tomcom, recording)
    print(f"a clock set back by 0.7 s: told after {uncertain_s:.2f} s, then {len(after)} samples on time; it verifies")


def send_by_schedule(tracker, t, hz, seconds, delay_s, told=None):
    """Sends samples with these stamps, each delayed by up to `delay_s`; `told` is asked twice a second whether what is waited for
    is there. Gives back after how many seconds it was."""
    chance, begun, last, found = random.Random(7), time.monotonic(), 0.0, None
    for number in range(int(seconds * hz)):
        due = max(last, number / hz + chance.uniform(0, delay_s))
        last = due
        time.sleep(max(0.0, begun + due - time.monotonic()))
        sample = {"x": 0.2 + 0.6 * (number % 1000) / 1000, "y": 0.5, "confidence": 1}
        if t is not None:
            sample["t"] = t(number / hz, number)
        tracker.sendall(json.dumps(sample).encode() + b"\n")
        if told and found is None and number % int(hz / 2) == 0 and told():
            found = time.monotonic() - begun
    return found


def lags(events, since_ns=0):
    """By how many seconds samples count as older than they arrived."""
    gaze = [event for event in events if event["kind"] == "gaze" and event["t_ns"] >= since_ns]
    return [(event["t_ns"] - event.get("taken_ns", event["t_ns"])) / 1e9 for event in gaze]


def check_clocks(tomcom, scratch):
    """Clocks at other rates, and what is no clock: told within five seconds, and stamped by arrival from then on. A rate that is told
    after little more than a second is only roughly right, as samples are delayed by up to 60 ms."""
    cases = {
        "slow loop": (lambda s, n: n / 120, 120 / 1.03, r"t runs at 9[5-9] % of real time"),
        "92 percent": (lambda s, n: 0.92 * s, 120, r"t runs at (89|9[0-5]) % of real time"),
        "half": (lambda s, n: 0.5 * s, 120, r"t runs at (4[5-9]|5[0-5]) % of real time"),
        "fast": (lambda s, n: 1e6 + 1.03 * s, 120, r"t runs at 10[1-5] % of real time"),
        "milliseconds": (lambda s, n: 1e3 * s, 120, r"t runs 1000 times as fast as real time, like milliseconds"),
        "microseconds": (lambda s, n: 1e6 * s, 120, r"t runs 1000000 times as fast"),
        "frames": (lambda s, n: n, 120, r"t runs 1[123]\d times as fast as real time, like counts"),
        "constant": (lambda s, n: 7.5, 120, r"t stands still"),
        "falling": (lambda s, n: 500 - s, 120, r"t goes back from sample to sample"),
    }
    said = []
    for name, (t, hz, words) in cases.items():
        with session(tomcom, scratch / name.replace(" ", "-")) as console:
            with connect() as tracker:
                after_s = send_by_schedule(tracker, t, hz, 12, 0.06, lambda: re.search(words, console.screen()))
                assert after_s is not None and after_s < 6, (name, after_s, console.screen())
                checks(console, "gaze times")
            recording = console.quit()
        events = recorded(recording)
        stamps = [event for event in events if event["kind"] == "tracker" and event["what"] == "stamps"]
        gaze = [event for event in events if event["kind"] == "gaze"]
        told_s = (stamps[0]["t_ns"] - gaze[0]["t_ns"]) / 1e9
        # The second one ends it: nothing is known about the stamps of the next sender.
        assert ["fault" in event for event in stamps] == [True, False] and told_s < 5, (name, stamps, told_s)
        late = sum(lag > 0.5 for lag in lags(events))
        assert late < hz and max(lags(events, stamps[0]["t_ns"] + 1)[: int(5 * hz)]) == 0, (name, late)
        verify(tomcom, recording)
        said.append(f"{name} after {told_s:.1f} s ({late} late of {len(gaze)})")
    with session(tomcom, scratch / "drift") as console:
        with connect() as tracker:
            send_by_schedule(tracker, lambda s, n: 1.0002 * s, 120, 12, 0.06)
        recording = console.quit()
    events = recorded(recording)
    assert not [event for event in events if event["kind"] == "tracker"] and max(lags(events)) < 0.15, max(lags(events))
    print(f"clocks: told of {'; '.join(said)}; 200 ppm followed without a word, at most {1000 * max(lags(events)):.0f} ms old", flush=True)


def check_standing_still(tomcom, scratch):
    """The program is stopped for 6 s: what waited meanwhile is not read as from now, and nothing of it is dropped."""
    for name, t in (("without-t", None), ("with-t", lambda s, n: s)):
        # tmux does not let its programs stand still.
        arguments = ["--participant", "keyboard", "--gaze", "json", "--out", scratch / name]
        with Console(tomcom, arguments) as console:
            console.wait_for("READY")
            stop, go = (f"os.kill({console.process.pid}, signal.{name})" for name in ("SIGSTOP", "SIGCONT"))
            stopper = subprocess.Popen([sys.executable, "-c", f"import os, signal, time; time.sleep(3); {stop}; time.sleep(6); {go}"])
            with connect() as tracker:
                send_by_schedule(tracker, t, 200, 12, 0.0)
            stopper.wait()
            console.wait_for("gaze idle")
            console.quit()
        (recording,) = (scratch / name).iterdir()
        events = recorded(recording)
        gaze = [event for event in events if event["kind"] == "gaze"]
        assert len(gaze) == 2400 and not [event for event in events if event["kind"] == "tracker" and event["what"] == "dropped"], len(gaze)
        # 1,200 samples waited, for 6 to 0 s; without stamps all count as having waited all the time.
        old = sum(lag > 0.5 for lag in lags(events))
        assert (1150 if t is None else 1050) < old <= 1250, (name, old)
        verify(tomcom, recording)
        print(f"stopped for 6 s, {name}: 2,400 samples recorded, {old} of those that waited counted as late", flush=True)


def check_held_places(tomcom, scratch):
    """40 connections that send a sample and then spaces keep no tracker out."""
    with session(tomcom, scratch / "places") as console:
        holders = [connect() for _ in range(40)]
        for holder in holders:
            holder.sendall(b'{"x": 0.9, "y": 0.9, "confidence": 1}\n')
        for _ in range(9):
            time.sleep(0.7)
            for holder in holders:
                try:
                    holder.sendall(b" ")
                except OSError:
                    pass
        trackers = []
        for _ in range(8):
            trackers.append(connect())
            send_by_schedule(trackers[-1], None, 120, 0.5, 0.0)
        recording = console.quit()
    fresh = [event for event in recorded(recording, "gaze") if event["x"] < 0.85]
    assert len(fresh) == 8 * 60, len(fresh)
    print(f"places: of 40 connections that send spaces, 8 gave way to trackers after 6 s; {len(fresh)} of their samples recorded", flush=True)


def check_many_ports(tomcom, scratch):
    """Datagrams from 50 ports with odd times do not move a tracker's clock."""
    with session(tomcom, scratch / "ports") as console, connect() as tracker:
        noise = (
            "import random, socket, time\n"
            "sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(50)]\n"
            f"while True:\n  for one in sockets:\n    one.sendto(b'{{\"t\": %f, \"x\": 0.95, \"y\": %f, \"confidence\": 1}}' % (random.uniform(0, 1e6), random.random()), ('127.0.0.1', {PORT}))\n    time.sleep(0.002)"
        )
        other = subprocess.Popen([sys.executable, "-c", noise])
        send_by_schedule(tracker, lambda s, n: s, 120, 10, 0.0)
        other.kill()
        other.wait()
        recording = console.quit()
    own = [event for event in recorded(recording, "gaze") if event["x"] < 0.9]
    worst = max((event["t_ns"] - event["taken_ns"]) / 1e9 for event in own)
    assert len(own) == 1200 and worst < 0.25, (len(own), worst)
    print(f"odd times from 50 ports: the tracker's {len(own)} samples count as at most {1000 * worst:.0f} ms old", flush=True)


def check_rejected(tomcom, scratch):
    """Senders that are rejected are counted, and the checks say what was found."""
    line = '{"x": 0.5, "y": 0.5, "confidence": 1}\n'
    cases = [
        ("mark", [("\ufeff" + line).encode()] * 3, "begins with a byte order mark"),
        ("utf-16", [line.encode("utf-16")] * 3, "its text is UTF-16"),
        ("no-newline", [line.strip().encode() * 200], "no line break"),
        ("long", [b'{"x": ' + b"1" * 5000], "longer than 4096 bytes"),
        ("repr", [b"{'x': 0.5}\n"], "begin with .{'x': 0.5}"),
    ]
    for name, pieces, words in cases:
        with session(tomcom, scratch / name) as console:
            with connect() as sender:
                try:
                    for piece in pieces:
                        sender.sendall(piece)
                        time.sleep(0.05)
                except OSError:
                    pass
            checks(console, words)
            console.wait_for("1 sender rejected")
            keys(console, "3")  # a session in which nothing happened leaves no recording
            console.quit()
    with session(tomcom, scratch / "datagrams") as console:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for _ in range(61):
                sender.sendto(("\ufeff" + line).encode(), ("127.0.0.1", PORT))
                time.sleep(0.02)
        checks(console, "byte order mark")
        console.wait_for("1 sender rejected")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto("\n".join(json.dumps({"x": n / 880, "y": 0.5, "confidence": 1}) for n in range(880)).encode(), ("127.0.0.1", PORT))
        time.sleep(0.3)
        found = re.findall(r"(\d+) Hz", console.screen())
        assert all(int(hz) <= 1000 for hz in found), found
        recording = console.quit()
    assert len(recorded(recording, "gaze")) == 880
    print("rejected senders: a byte order mark, UTF-16, no line break, a long line and Python's dictionary are told; 61 datagrams are one sender; 880 samples at once", flush=True)


if __name__ == "__main__":
    program, folder = sys.argv[1], Path(sys.argv[2])
    check_sender(program, folder)
    check_documented_sender(program, folder)
    check_set_clock(program, folder)
    check_clocks(program, folder / "clocks")
    check_standing_still(program, folder / "still")
    check_held_places(program, folder)
    check_many_ports(program, folder)
    check_rejected(program, folder / "rejected")
