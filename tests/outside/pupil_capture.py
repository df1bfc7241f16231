"""Drives sessions with Pupil Capture's own modules (see pupil_modules.py), and looks into Capture's recordings.

    tests/outside/pupil_capture.py TOMCOM FOLDER PUPIL [--trials 20]

PUPIL is a clone of github.com/pupil-labs/pupil.
"""

import atexit
import json
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import msgpack
import zmq

from console import Console, parser, percentile, recorded, verify
from pupil import session, start_trial

HERE = Path(__file__).parent
PORT = 20630


class Modules:
    """Capture's modules in a process of their own."""

    def __init__(self, pupil, folder, port, *options):
        self.folder = folder
        command = [sys.executable, HERE / "pupil_modules.py", pupil, port, folder, *options]
        folder.mkdir(parents=True, exist_ok=True)
        self.errors = open(folder / "errors.txt", "a")
        self.process = subprocess.Popen([str(part) for part in command], stderr=self.errors)
        atexit.register(self.process.kill)
        self.wait_for("began")

    def notes(self, what):
        journal = self.folder / "journal.jsonl"
        lines = journal.read_text().splitlines() if journal.exists() else []
        return [note for note in map(json.loads, lines) if note["what"] == what]

    def subjects(self):
        return [note["subject"] for note in self.notes("notice")]

    def wait_for(self, what, seconds=30):
        until = time.monotonic() + seconds
        while not self.notes(what):
            assert self.process.poll() is None and time.monotonic() < until, (self.folder / "errors.txt").read_text()[-2000:]
            time.sleep(0.1)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def annotations(self):
        """The labels in each of Capture's recordings, by its session's name and number."""
        found = {}
        for recording in sorted((self.folder / "recordings").glob("*/*")):
            path = recording / "annotation.pldata"
            labels = []
            if path.exists():
                for _, payload in msgpack.Unpacker(open(path, "rb"), use_list=False, strict_map_key=False):
                    labels.append(msgpack.unpackb(payload, strict_map_key=False))
            found[f"{recording.parent.name}/{recording.name}"] = labels
        return found

    def labels(self):
        return {name: [one["label"] for one in found] for name, found in self.annotations().items()}


@contextmanager
def operate(tomcom, folder, port, surface="Surface 1", more=""):
    """A session at the console."""
    path = session(folder, port, more=f'surface = "{surface}"\n{more}')
    with Console(tomcom, [path, "--out", folder / "recordings"]) as console:
        yield console


@contextmanager
def trial(tomcom, folder, port, more=""):
    """A session whose trial runs."""
    with operate(tomcom, folder, port, more=more) as console:
        console.wait_for(r"gaze +\d\d+ Hz")
        start_trial(console)
        yield console


def trackers(recording, what):
    return [event for event in recorded(recording, "tracker") if event["what"] == what]


def check_trials(tomcom, folder, pupil, trials):
    """Each trial is in a recording of Capture's, from its start to its end."""
    capture = Modules(pupil, folder / "capture", PORT)
    for _ in range(trials):
        with trial(tomcom, folder, PORT) as console:
            time.sleep(1.0)
            console.end()
            console.quit()
    found = capture.annotations()
    capture.kill()
    names = sorted(recording.name for recording in (folder / "recordings").iterdir())
    assert sorted(name.split("/")[0] for name in found) == names, (list(found), names)
    labels = {name: [one["label"] for one in annotations] for name, annotations in found.items()}
    whole = [name for name, found in labels.items() if found[0] == "trial started" and found[-1] == "trial ended"]
    assert len(whole) == trials, labels
    late = [annotations[0]["late_s"] for annotations in found.values()]
    plugins = [note for note in capture.notes("notice") if note["subject"] == "start_plugin"]
    assert len(plugins) == 1, "the annotation plugin is started once, and kept by all sessions after that"
    print(
        f"Capture's own recorder: {len(whole)} of {trials} trials have their start and their end in its recording; "
        f"the start is annotated {1000 * percentile(late, 0.5):.0f} ms late (p50), at most {1000 * max(late):.0f} ms", flush=True)


def check_restart(tomcom, folder, pupil):
    """Capture is killed in a trial; its next recording says that the trial runs."""
    capture = Modules(pupil, folder / "capture", PORT + 1)
    with trial(tomcom, folder, PORT + 1) as console:
        time.sleep(1)
        capture.kill()
        console.wait_for("NO TRACKER")
        capture = Modules(pupil, folder / "capture", PORT + 1)
        console.wait_for(r"gaze +\d\d+ Hz")
        time.sleep(2)
        console.end()
        console.quit()
    time.sleep(0.5)
    labels = list(capture.labels().values())
    capture.kill()
    assert labels[-1][0] == "trial running" and labels[-1][-1] == "trial ended", labels
    print(f"Capture restarted in a trial: its new recording begins with {labels[-1][0]!r}", flush=True)


def check_lab(tomcom, folder, pupil):
    """A recording that the lab began is annotated, and runs on after the trial; with `record = false`, too."""
    capture = Modules(pupil, folder / "capture", PORT + 2, "--lab-records")
    for more in ("record = true\n", "record = false\n"):
        with trial(tomcom, folder, PORT + 2, more=more) as console:
            if "true" in more:
                console.wait_for("started no recording", 10)
            time.sleep(0.5)
            console.end()
            console.quit()
    time.sleep(1)
    subjects = capture.subjects()
    assert "recording.stopped" not in subjects and "recording.should_stop" not in subjects, subjects
    assert subjects.count("recording.started") == 1, subjects
    annotated = [note["label"] for note in capture.notes("annotation")]
    assert annotated.count("trial started") == annotated.count("trial ended") == 2, annotated
    capture.kill()
    print("a recording that the lab began: annotated with two trials, and never ended", flush=True)


def check_kill(tomcom, folder, pupil):
    """The program is killed in a trial that Capture records: the continued trial goes on in that recording, and ends it."""
    capture = Modules(pupil, folder / "capture", PORT + 7)
    with trial(tomcom, folder, PORT + 7) as console:
        time.sleep(1.5)
        console.process.kill()
        console.process.wait()
    (recording,) = (folder / "recordings").iterdir()
    with Console(tomcom, ["--continue", recording]) as console:
        console.wait_for("recording of this trial goes on", 20)
        time.sleep(0.5)
        console.end()
        console.quit()
    time.sleep(1)
    subjects, labels = capture.subjects(), list(capture.labels().values())
    assert subjects.count("recording.started") == subjects.count("recording.stopped") == 1, subjects
    # A trial that is continued is paused at first.
    assert labels == [["trial started", "trial paused", "trial ended"]], labels
    # Killed again, and Capture's recording is ended by hand meanwhile: the continued trial has a new one.
    with trial(tomcom, folder / "again", PORT + 7) as console:
        time.sleep(1.5)
        console.process.kill()
        console.process.wait()
    remote = zmq.Context.instance().socket(zmq.REQ)
    remote.connect(f"tcp://127.0.0.1:{PORT + 7}")
    remote.send_string("r")
    remote.recv_string()
    (recording,) = (folder / "again" / "recordings").iterdir()
    with Console(tomcom, ["--continue", recording]) as console:
        console.wait_for(r"gaze +\d\d+ Hz")
        time.sleep(1.5)
        console.end()
        console.quit()
    time.sleep(1)
    subjects, labels = capture.subjects(), list(capture.labels().values())
    capture.kill()
    assert subjects.count("recording.started") == subjects.count("recording.stopped") == 3, subjects
    assert ["trial paused", "trial ended"] in labels, labels
    print("killed in a trial and continued: Capture's recording goes on and is ended with the trial; one that was ended meanwhile is followed by a new one", flush=True)


def check_leave(tomcom, folder, pupil):
    """Whoever leaves in the trial ends it, also in Capture's recording."""
    capture = Modules(pupil, folder / "capture", PORT + 8)
    with trial(tomcom, folder, PORT + 8) as console:
        time.sleep(1.5)
        console.quit()
    time.sleep(1)
    subjects, (labels,) = capture.subjects(), capture.labels().values()
    capture.kill()
    assert labels == ["trial started", "session left", "trial ended"] and subjects.count("recording.stopped") == 1, (labels, subjects)
    print(f"left by ^c in the trial: Capture's recording has {', '.join(labels)}, and is ended", flush=True)


def check_clock(tomcom, folder, pupil):
    """Capture's clock is set ahead and back by 0.2 s."""
    capture = Modules(pupil, folder / "capture", PORT + 3)
    remote = zmq.Context.instance().socket(zmq.REQ)
    remote.connect(f"tcp://127.0.0.1:{PORT + 3}")

    def ask(request):
        remote.send_string(request)
        return remote.recv_string()

    def offset():
        """Capture's time less that of this computer, from the quickest of many answers."""
        answers = []
        for _ in range(30):
            asked = time.monotonic()
            found = float(ask("t"))
            answers.append((time.monotonic() - asked, found - (asked + time.monotonic()) / 2))
        return min(answers)[1]

    with trial(tomcom, folder, PORT + 3) as console:
        time.sleep(4)
        offsets = [offset()]
        for by, word in ((0.2, "ahead"), (-0.2, "back")):
            assert ask(f"T {float(ask('t')) + by}") == "Timesync successful."
            console.wait_for(f"clock was set {word} by 0[.](19|20)")
            time.sleep(4)
            offsets.append(offset())
        console.end()
        console.quit()
    capture.kill()
    (recording,) = (folder / "recordings").iterdir()
    verify(tomcom, recording)
    steps = trackers(recording, "clock_set")
    assert [round(step["by_s"], 2) for step in steps] == [0.2, -0.2], steps
    # Session time less Capture's: between the steps it changes by as much as Capture's clock was set.
    gaze = recorded(recording, "gaze")
    times = [0, *(step["t_ns"] for step in steps), 1e18]
    stamped = []
    for since, until in zip(times, times[1:]):
        ahead = [event["taken_ns"] - event["device_ns"] for event in gaze if since + 0.3e9 < event["t_ns"] < until - 0.3e9]
        stamped.append((min(ahead) / 1e9, max(ahead) / 1e9))
    wrong = [abs(low + offsets[n] - stamped[0][0] - offsets[0]) for n, edges in enumerate(stamped) for low in edges]
    uncertain = [(step["t_ns"] - step["uncertain_since_ns"]) / 1e9 for step in steps]
    assert max(wrong) < 0.005, (stamped, offsets)
    assert max(uncertain) < 1, uncertain
    shown = json.loads(subprocess.run([tomcom, "replay", recording, "--format", "json"], capture_output=True, check=True).stdout)["gaze"]
    unread = shown["out_of_order"] + shown["too_old"]
    rate = len(gaze) / ((gaze[-1]["t_ns"] - gaze[0]["t_ns"]) / 1e9)
    assert unread < rate, (unread, rate)
    print(
        f"Capture's clock set by 0.2 s ahead and back: told after {max(uncertain):.2f} s at most, stamps then right to "
        f"{1000 * max(wrong):.2f} ms, {unread} samples of {rate:.0f} Hz unread", flush=True)


def check_time_sync(tomcom, folder, pupil):
    """Capture's plugin Time Sync follows another clock: it sets Capture's once, and slews it twice in the trial."""
    capture = Modules(pupil, folder / "capture", PORT + 6, "--time-sync")
    with operate(tomcom, folder, PORT + 6) as console:
        console.wait_for(r"gaze +\d\d+ Hz")
        console.wait_for("clock was set ahead by 0[.]05")
        start_trial(console)
        time.sleep(36)
        console.end()
        console.quit()
    bases = capture.notes("timebase")
    capture.kill()
    (recording,) = (folder / "recordings").iterdir()
    verify(tomcom, recording)
    [step] = trackers(recording, "clock_set")
    assert abs(step["by_s"] - 0.05) < 0.003, step
    changes = [(note["t"], note["base"], abs(note["base"] - before["base"])) for before, note in zip(bases, bases[1:])]
    slews = [(at, by) for at, _, by in changes if by < 0.01]
    assert len(slews) > 20 and sum(by for _, by in slews) > 0.012, slews
    # The script's gaze has the time base of its frame, so that its true time is known.
    gaze = [event for event in recorded(recording, "gaze") if event["t_ns"] > step["t_ns"] + 1e9]

    def behind(pupil_s):
        return [note["base"] for note in bases if note["t"] <= pupil_s + 0.001][-1]

    ahead = [event["taken_ns"] / 1e9 - event["device_ns"] / 1e9 - behind(event["device_ns"] / 1e9) for event in gaze]
    # What holds before the first slew is right: Capture's clock has been compared for seconds then.
    quiet = [value for event, value in zip(gaze, ahead) if event["device_ns"] / 1e9 < slews[0][0]]
    right = sorted(quiet)[len(quiet) // 2]
    worst = max(abs(value - right) for value in ahead)
    assert len(quiet) > 100 and worst < 0.005, (len(quiet), worst)
    print(
        f"Time Sync: Capture's clock set by 0.05 s is told; slewed {len(slews)} times by {1000 * sum(by for _, by in slews):.1f} ms in all, stamps of "
        f"{len(gaze)} samples are right to {1000 * worst:.2f} ms meanwhile", flush=True)


def check_eyes(tomcom, folder, pupil):
    """Fixations and blinks of Capture's online detectors are what the eyes did."""
    capture = Modules(pupil, folder / "capture", PORT + 4)
    with operate(tomcom, folder, PORT + 4) as console:
        console.wait_for(r"gaze +\d\d+ Hz")
        # Sixteen blinks, one in 1.6 s, the first one after 9.6 s.
        time.sleep(38)
        console.quit()
    capture.kill()
    (recording,) = (folder / "recordings").iterdir()
    fixations = [event["duration_ms"] / 1000 for event in trackers(recording, "fixation")]
    blinks = [event["closed"] for event in trackers(recording, "blink")]
    heard = len(capture.notes("blink"))
    # The session may have begun in the middle of the first one. The detector looks once in a frame, and so finds each up to a frame late.
    longest = [seconds for seconds in fixations[1:] if seconds > 1.5]
    assert len(longest) >= 5 and all(-1 / 30 - 0.02 < seconds - 1.94 < 0.02 for seconds in longest), fixations
    assert blinks == [True, False] * 16, (blinks, heard)
    print(
        f"the eyes: fixations of 1.94 s are {min(longest):.2f} to {max(longest):.2f} s; {sum(blinks)} blinks of 16, "
        f"of {heard} messages", flush=True)


def check_surface(tomcom, folder, pupil):
    """Another surface than the session's is seen: its name is told."""
    capture = Modules(pupil, folder / "capture", PORT + 5)
    with operate(tomcom, folder, PORT + 5, surface="wall") as console:
        console.wait_for("NO DISPLAY TAGS")
        console.wait_for('other surfaces: "Surface 1"')
        console.key(".")
        console.wait_for('sees "Surface 1", not "wall"')
        console.key("\x1b")
        console.quit()
    capture.kill()
    print('a session for the surface "wall": told that Capture sees "Surface 1"', flush=True)


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("pupil")
    asked.add_argument("--trials", type=int, default=20)
    asked.add_argument("--only", choices=["trials", "restart", "lab", "kill", "leave", "clock", "time-sync", "eyes", "surface"])
    options = asked.parse_args()
    checks = {"restart": check_restart, "lab": check_lab, "kill": check_kill, "leave": check_leave, "clock": check_clock, "time-sync": check_time_sync, "eyes": check_eyes, "surface": check_surface}
    if options.only in (None, "trials"):
        check_trials(options.tomcom, options.folder / "trials", options.pupil, options.trials)
    for name, check in checks.items():
        if options.only in (None, name):
            check(options.tomcom, options.folder / name, options.pupil)
