"""A live console in a pseudo terminal: keys go in as bytes, the screen is what a terminal emulator makes of the output."""

import argparse
import fcntl
import json
import os
import pty
import re
import resource
import select
import struct
import subprocess
import termios
import threading
import time
from pathlib import Path

import pyte

# What the program asks of a terminal, and what this one answers: a black background, and that it is a terminal.
ANSWERS = {b"\x1b]11;?\x1b\\": b"\x1b]11;rgb:0000/0000/0000\x1b\\", b"\x1b[c": b"\x1b[?62;22c"}

# A question is not answered by its own key for a shorter time: it might be held down.
OWN_KEY_S = 1


def prepare(files):
    """Takes the terminal, in the process that becomes the program."""
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    if files:
        resource.setrlimit(resource.RLIMIT_NOFILE, (files, files))


class Console:
    """Runs `tomcom operate`, or another command, with these arguments until it is left by `with`."""

    def __init__(self, tomcom, arguments, size=(120, 40), files=None, command="operate"):
        """`files`: at most so many open files."""
        self.screen = pyte.Screen(*size)
        self.stream = pyte.ByteStream(self.screen)
        self.lock = threading.Lock()
        self.watched = None
        self.drawn = None
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
        environment = {**os.environ, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8"}
        environment.pop("NO_COLOR", None)
        self.process = subprocess.Popen(
            [tomcom, command, *map(str, arguments)],
            stdin=slave, stdout=slave, stderr=slave, env=environment, start_new_session=True,
            preexec_fn=lambda: prepare(files),
        )
        os.close(slave)
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        while True:
            try:
                output = os.read(self.master, 1 << 16)
            except OSError:
                return
            if not output:
                return
            for question, answer in ANSWERS.items():
                if question in output:
                    os.write(self.master, answer)
            # pyte knows no private sequences that end in u (keyboard protocol).
            output = re.sub(rb"\x1b\[[<>=?][0-9;]*u", b"", output)
            with self.lock:
                self.stream.feed(output)
                if self.watched and self.watched(self.screen.display):
                    self.drawn, self.watched = time.monotonic(), None

    def watch(self, is_there):
        """From now on the time is noted at which this is on the screen: see `drawn`."""
        with self.lock:
            self.drawn, self.watched = None, is_there

    def text(self):
        with self.lock:
            return "\n".join(self.screen.display)

    def wait_for(self, pattern, seconds=30):
        until = time.monotonic() + seconds
        while not re.search(pattern, self.text()):
            assert self.process.poll() is None, f"the console has ended:\n{self.text()}"
            assert time.monotonic() < until, f"{pattern} did not appear:\n{self.text()}"
            time.sleep(0.02)

    def key(self, key):
        self.write(key.encode())

    def write(self, sent):
        os.write(self.master, sent)

    def start(self):
        """Starts the trial, as soon as nothing that is looked at before it speaks against it, but that nobody checked the gaze."""
        self.key(".")
        self.wait_for("RUNNING|Checks before the trial")
        if "RUNNING" not in self.text():
            # Gaze that has only just begun to arrive is slow for a second.
            self.wait_for(r"start the trial +esc close|ok +gaze +\d+ gaze samples(.|\n)*start the trial anyway")
            # Where nothing was wrong any more when the list came up, that was only just now.
            time.sleep(OWN_KEY_S)
            self.key("o" if "start the trial anyway" in self.text() else ".")
            self.wait_for("RUNNING")

    def end(self):
        """Ends the trial."""
        self.key("\x05")
        self.wait_for("End the trial")
        self.key("y")
        self.wait_for("OVER|over")

    def trial_s(self):
        """The trial's clock, as the head line shows it, in seconds."""
        clock = re.search(r"(\d+):(\d\d) / ", self.text())
        return 60 * int(clock[1]) + int(clock[2]) if clock else 0

    def cpu_s(self):
        """Seconds of processor time so far."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def rss_bytes(self):
        return int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def quit(self):
        self.key("\x03")
        self.wait_for("Quit tomcom")
        self.key("y")
        assert self.process.wait(30) == 0, self.text()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        # What the reader waits for ends with the terminal.
        while select.select([self.master], [], [], 0)[0] and self.reader.is_alive():
            time.sleep(0.01)
        os.close(self.master)


class Tmux:
    """A live session in a terminal of its own, whose screen tmux makes."""

    def __init__(self, tomcom, out, *arguments):
        self.server, self.out = f"tomcom-outside-{os.getpid()}", Path(out)
        self.tmux("-f", "/dev/null", "new-session", "-d", "-x", "120", "-y", "40", tomcom, *arguments, "--out", out)
        self.wait_for("READY")

    def tmux(self, *arguments):
        return subprocess.run(["tmux", "-L", self.server, *map(str, arguments)], capture_output=True, text=True).stdout

    def screen(self):
        return "\n".join(line.rstrip() for line in self.tmux("capture-pane", "-p").split("\n")).rstrip()

    def key(self, key):
        self.tmux("send-keys", key)

    def wait_for(self, pattern, seconds=60):
        until = time.monotonic() + seconds
        while not re.search(pattern, self.screen()):
            assert time.monotonic() < until, f"{pattern} did not appear:\n{self.screen()}"
            time.sleep(0.02)

    def quit(self):
        """Quits and gives back the recording's folder."""
        self.key("C-c")
        self.wait_for("Quit tomcom")
        self.key("y")
        until = time.monotonic() + 30
        while self.screen():
            assert time.monotonic() < until, f"the console does not end:\n{self.screen()}"
            time.sleep(0.05)
        (recording,) = self.out.iterdir()
        return recording

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.tmux("kill-server")


class Log:
    """The end of a log that grows."""

    def __init__(self, recording):
        self.file = open(recording / "events.jsonl", "rb", buffering=0)
        self.rest = b""

    def new_lines(self):
        *lines, self.rest = (self.rest + self.file.read(1 << 24)).split(b"\n")
        return lines


def session_file(folder, **participant):
    """A session that does not end by itself, in this folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "session.toml"
    settings = "\n".join(f"{name} = {value!r}" for name, value in participant.items()).replace("'", '"')
    layout = Path("layouts/sushi.toml").resolve()
    path.write_text(
        f'layout = "{layout}"\n[trial]\npresses = 4000000000\nseconds = 86400.0\n'
        f"[signals]\ncool_down_s = 0.0\n[participant]\n{settings}\n"
    )
    return path


def recorded(recording, kind=None):
    """The events of a recording; with `kind`, those of this one."""
    events = map(json.loads, (recording / "events.jsonl").read_text().splitlines()[1:])
    return [event for event in events if kind is None or event["kind"] == kind]


def verify(tomcom, recording):
    done = subprocess.run([tomcom, "replay", recording, "--verify", "--format", "json"], capture_output=True, text=True)
    assert done.returncode == 0 and json.loads(done.stdout)["verified"] is True, done


def parser(doc):
    """Of a check's arguments."""
    made = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("tomcom")
    made.add_argument("folder", type=Path)
    return made


def percentile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]
