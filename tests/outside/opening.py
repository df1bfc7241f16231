"""Times to what is seen first, of the real program in a pseudo terminal: the console without arguments, the replay of a recording of 15 minutes
with 108,000 samples of gaze, a move to any place in it, and the list of many recordings. It fails at three times the bound.

    tests/outside/opening.py TOMCOM FOLDER [--recordings 1000] [--repeats 10]
"""

import argparse
import fcntl
import json
import os
import pty
import random
import re
import select
import shutil
import statistics
import struct
import subprocess
import termios
import time
from pathlib import Path

import pyte

from console import ANSWERS
from simulated import recordings_in, run, shortened

# Bounds in milliseconds.
CONSOLE, REPLAY, SEEK, LIST = 100, 300, 100, 300
COLUMNS, ROWS = 140, 45
SAMPLES, SECONDS = 108_000, 900


class Terminal:
    """A program in a pseudo terminal of its own, read by this process alone: nothing else takes its time."""

    def __init__(self, *arguments, folder):
        self.screen = pyte.Screen(COLUMNS, ROWS)
        self.stream = pyte.ByteStream(self.screen)
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
        environment = {**os.environ, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8"}
        environment.pop("NO_COLOR", None)
        self.began = time.monotonic()
        self.process = subprocess.Popen(
            [str(one) for one in arguments], stdin=slave, stdout=slave, stderr=slave, env=environment, cwd=folder, start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
        )
        os.close(slave)

    def until(self, is_there, seconds=120):
        """Milliseconds from now, or from the start if that is the first time, until the screen shows this."""
        began, self.began = self.began or time.monotonic(), None
        # What is there already has arrived.
        end, arrived = began + seconds, time.monotonic()
        while not is_there(self.screen.display):
            assert time.monotonic() < end, "it did not appear:\n" + "\n".join(self.screen.display)
            if not select.select([self.master], [], [], 0.5)[0]:
                continue
            output = os.read(self.master, 1 << 16)
            arrived = time.monotonic()
            for question, answer in ANSWERS.items():
                if question in output:
                    os.write(self.master, answer)
            self.stream.feed(re.sub(rb"\x1b\[[<>=?][0-9;]*u", b"", output))
        return 1000 * (arrived - began)

    def send(self, text):
        self.began = time.monotonic()
        os.write(self.master, text.encode())

    def end(self):
        self.process.kill()
        self.process.wait()
        os.close(self.master)


def has(text):
    return lambda lines: any(text in line for line in lines)


def clock_s(text):
    minutes, seconds = text.split(":")
    return 60 * int(minutes) + float(seconds)


def position(lines):
    """Where the replay is and how long it is, in seconds, with row and first and last column of the bar; None without a bar."""
    for row, line in enumerate(lines):
        found = re.search(r" recording (\S+) .*?(\d+:[\d.]+) of (\d+:[\d.]+)", line)
        if found:
            return clock_s(found[2]), clock_s(found[3]), row, found.start(1), found.end(1)
    return None


def long_recording(tomcom, folder):
    """A simulated trial of a quarter of an hour, with further samples of gaze among its own."""
    session = shortened("sessions/default.toml", folder / "long.toml", 100_000)
    session.write_text(re.sub(r"(?m)^seconds = .*", f"seconds = {SECONDS}.0", session.read_text()))
    run(tomcom, "simulate", session, "--arm", "timed", "--trials", 1, "--seed", 9814, "--out", folder / "long")
    (recording,) = recordings_in(folder / "long")
    head, *lines = (recording / "events.jsonl").read_text().splitlines()
    events = [json.loads(line) for line in lines]
    samples = sum(event["kind"] == "gaze" for event in events)
    each, left = divmod(SAMPLES, samples)
    made = []
    for event, after in zip(events, [*events[1:], None]):
        made.append(event)
        if event["kind"] == "gaze" and after is not None:
            more = each - 1 + (left > 0)
            left -= left > 0
            step = (after["t_ns"] - event["t_ns"]) // (more + 1)
            made += [{**event, "t_ns": event["t_ns"] + nth * step} for nth in range(1, more + 1)]
    for number, event in enumerate(made):
        event["seq"] = number
    (recording / "events.jsonl").write_text("".join(line + "\n" for line in [head, *(json.dumps(event, separators=(",", ":")) for event in made)]))
    samples = sum(event["kind"] == "gaze" for event in made)
    print(f"  the recording: {len(made)} events, {samples} samples of gaze, {made[-1]['t_ns'] / 1e9:.0f} s, {(recording / 'events.jsonl').stat().st_size / 1e6:.1f} MB")
    assert abs(samples - SAMPLES) < SAMPLES / 50, samples
    return recording


def replay(tomcom, recording, repeats):
    """Times to the first frame, and times of moves to random places, in milliseconds."""
    frames, moves, chance = [], [], random.Random(9815)
    for _ in range(repeats):
        terminal = Terminal(tomcom, "replay", recording, folder=Path.cwd())
        frames.append(terminal.until(lambda lines: position(lines) is not None))
        terminal.until(has("paused"))
        # At the end all of it is read.
        terminal.send("\x1b[F")
        terminal.until(lambda lines: position(lines)[0] > 0.99 * position(lines)[1])
        for _ in range(10):
            _, length, row, first, last = position(terminal.screen.display)
            column = chance.randrange(first, last)
            wanted = length * (column - first) / (last - first - 1)
            is_there = lambda lines: abs(position(lines)[0] - wanted) < length / 50
            if is_there(terminal.screen.display):
                continue
            terminal.send(f"\x1b[<0;{column + 1};{row + 1}M\x1b[<0;{column + 1};{row + 1}m")
            moves.append(terminal.until(is_there, seconds=20))
        terminal.end()
    return frames, moves


def console(tomcom, folder, repeats):
    times = []
    for _ in range(repeats):
        terminal = Terminal(tomcom, folder=folder)
        times.append(terminal.until(lambda lines: sum(bool(line.strip()) for line in lines) > 5))
        terminal.end()
    return times


def listed(tomcom, folder, number, repeats):
    """Times of lists of so many recordings, which are copies of some."""
    session = shortened("sessions/default.toml", folder / "short.toml", 304)
    run(tomcom, "simulate", session, "--arm", "timed", "--trials", 4, "--seed", 9816, "--out", folder / "few")
    few, many = recordings_in(folder / "few"), folder / "many"
    for nth in range(number):
        shutil.copytree(few[nth % len(few)], many / f"trial-{nth:04}")
    size = (few[0] / "events.jsonl").stat().st_size / 1e6
    print(f"  {number} recordings of {size:.1f} MB")
    times, outputs = [], set()
    for _ in range(repeats):
        began = time.monotonic()
        outputs.add(run(tomcom, "list", many))
        times.append(1000 * (time.monotonic() - began))
    assert len(outputs) == 1 and f"{number} recordings in" in outputs.pop(), "lists differ"
    return times


def tell(what, times, bound):
    """Prints a measurement; returns whether it is within three times the bound."""
    times = sorted(times)
    middle, most = statistics.median(times), times[-1]
    print(f"{what}: median {middle:.0f} ms, at most {most:.0f} ms of {len(times)} (asked: {bound} ms)", flush=True)
    return middle <= 3 * bound


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--recordings", type=int, default=1000)
    parser.add_argument("--repeats", type=int, default=10)
    arguments = parser.parse_args()
    tomcom, folder = arguments.tomcom.resolve(), arguments.folder / f"opening-{os.getpid()}"
    folder.mkdir(parents=True)
    home = folder / "home"
    home.mkdir()
    for name in ("sessions", "layouts", "recipes"):
        shutil.copytree(name, home / name)
    within = [tell("tomcom to its first frame", console(tomcom, home, arguments.repeats), CONSOLE)]
    frames, moves = replay(tomcom, long_recording(tomcom, folder), arguments.repeats)
    within += [tell("replay to its first frame", frames, REPLAY), tell("a move to any place", moves, SEEK)]
    times = listed(tomcom, folder, arguments.recordings, max(2, arguments.repeats // 3))
    # The first list may have to read every recording; what is asked is the list of a folder that is looked at every day.
    print(f"the first list of these: {times[0]:.0f} ms")
    within.append(tell(f"list of {arguments.recordings} recordings", times[1:], LIST))
    shutil.rmtree(folder)
    assert all(within), "more than three times the bound"


if __name__ == "__main__":
    main()
