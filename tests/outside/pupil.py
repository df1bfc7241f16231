"""Drives whole sessions with a stand-in for Pupil Capture, and looks for everything that it sent in the recording.

    tests/outside/pupil.py TOMCOM FOLDER [--seconds 20] [--fast-seconds 20]
"""

import atexit
import json
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

from console import Console, parser, percentile, recorded, verify

HERE = Path(__file__).parent
PORT = 20620
# From sending to the update of the belief, in seconds: the median.
LIMIT_S = 0.005
# Keys, and what is said of them.
NOTES = [("1", "wrong recipe"), ("2", "overlooked a change")]


def kitchen(tomcom, name="sushi"):
    """Where the surface is, and the centres of the locations, of the program's own layout."""
    done = subprocess.run([tomcom, "kitchen", f"layouts/{name}.toml", "--format", "json"], capture_output=True, check=True)
    corners = json.loads(done.stdout)["tags"]["surface"]
    surface = [corners[0][0], corners[0][1], corners[2][0], corners[2][1]]
    layout = tomllib.loads(Path(f"layouts/{name}.toml").read_text())
    places = {}
    for location in layout["order"] + layout["hand"] + layout["place"]:
        area = location["display"]
        places[location["name"]] = (area["x"] + area["w"] / 2, area["y"] + area["h"] / 2)
    return surface, places


def session(folder, port, name="sushi", gaze="pupil", more=""):
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "session.toml"
    layout = Path(f"layouts/{name}.toml").resolve()
    path.write_text(
        f'layout = "{layout}"\n[trial]\npresses = 4000\nseconds = 86400.0\n'
        f'[participant]\ngaze = "{gaze}"\n[tracker]\nport = {port}\n{more}'
    )
    return path


class StandIn:
    def __init__(self, folder, port, surface, places, *options):
        folder.mkdir(parents=True, exist_ok=True)
        self.journal = Path(tempfile.mktemp(dir=folder, suffix=".jsonl"))
        points = [f"{x},{y}" for x, y in places.values()]
        command = [sys.executable, HERE / "capture.py", str(port), self.journal, "--surface", *map(str, surface)]
        self.process = subprocess.Popen([*command, "--points", *points, *map(str, options)])
        atexit.register(self.process.kill)

    def notes(self, what=None):
        lines = self.journal.read_text().splitlines() if self.journal.exists() else []
        notes = []
        for line in lines:
            try:
                notes.append(json.loads(line))
            except json.JSONDecodeError:
                pass  # The last line of one that was killed.
        return [note for note in notes if what is None or note["what"] == what]

    def wait_for(self, what, seconds=60):
        until = time.monotonic() + seconds
        while not self.notes(what):
            assert self.process.poll() is None, "the stand-in ended"
            assert time.monotonic() < until, f"no {what}: {self.notes()[:5]}"
            time.sleep(0.1)

    def kill(self):
        self.process.kill()
        self.process.wait()


def timing(tomcom, recording):
    research = Path(tomcom).with_name("tomcom-research")
    done = subprocess.run([research, "speed", recording, "--format", "json"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def start_trial(console):
    console.key(".")
    time.sleep(1)
    if "RUNNING" not in console.text():
        console.key("o")
    console.wait_for("RUNNING")


def compare(sent, gaze, surface, places):
    """Every sample arrived, at the place that it was meant for; seconds from sending to the session, of each."""
    x0, y0, x1, y1 = surface
    assert len(gaze) == len(sent), f"{len(gaze)} samples of {len(sent)} arrived"
    latencies, located = [], 0
    for found, note in zip(gaze, sent):
        assert abs(found["device_ns"] / 1e9 - note["t"]) < 1e-6, (found, note)
        x, y = x0 + note["norm_pos"][0] * (x1 - x0), y0 + (1 - note["norm_pos"][1]) * (y1 - y0)
        assert abs(found["x"] - x) < 2e-5 and abs(found["y"] - y) < 2e-5, (found, x, y)
        located += any(abs(found["x"] - px) < 1e-4 and abs(found["y"] - py) < 1e-4 for px, py in places.values())
        # The session knows when a sample was taken; it was sent a little later.
        taken = found.get("taken_ns", found["t_ns"]) / 1e9
        latencies.append(found["t_ns"] / 1e9 - (taken + note["sent"] - note["t"]))
    assert located == len(gaze), f"{located} of {len(gaze)} samples on a location"
    return latencies


def check_session(tomcom, folder, seconds, name):
    """A whole session at 30 frames a second with 8 samples each."""
    surface, places = kitchen(tomcom, name)
    stand_in = StandIn(folder, PORT, surface, places, "--seconds", seconds)
    path = session(folder, PORT, name)
    with Console(tomcom, [path, "--out", folder / "recordings"]) as console:
        stand_in.wait_for("began")
        console.wait_for(r"gaze +2\d\d Hz")
        start_trial(console)
        stand_in.wait_for("ended", seconds + 60)
        time.sleep(0.5)
        console.end()
        console.quit()
    (recording,) = (folder / "recordings").iterdir()
    gaze = recorded(recording, "gaze")
    latencies = compare(stand_in.notes("sample"), gaze, surface, places)
    update_us = timing(tomcom, recording)["gaze_us"]["p50"]
    median = percentile(latencies, 0.5) + update_us / 1e6
    trackers = recorded(recording, "tracker")
    kinds = {event["what"] for event in trackers}
    assert {"connected", "display_found", "fixation", "blink"} <= kinds, kinds
    fixations = [event for event in trackers if event["what"] == "fixation"]
    assert len(fixations) >= seconds / 0.4 - 3, len(fixations)
    requests = [note["request"] for note in stand_in.notes("request")]
    assert f"R {recording.name}" in requests and "r" in requests, requests
    assert "notify.start_plugin" in requests, requests
    annotations = [note["label"] for note in stand_in.notes("annotation")]
    assert annotations[0] == "trial started" and annotations[-1] == "trial ended", annotations
    assert set(note["topic"] for note in stand_in.notes("subscription")) >= {"surfaces.", "fixations", "blinks"}
    stand_in.kill()
    verify(tomcom, recording)
    presses = len(recorded(recording, "press"))
    print(
        f"Pupil, {name}: {len(gaze)} samples of 30 frames/s, all arrived on their locations, {presses} presses meanwhile; "
        f"sending to belief update p50 {1000 * median:.2f} ms, p99 {1000 * percentile(latencies, 0.99):.1f} ms; "
        f"{len(fixations)} fixations; recorded and annotated along; the recording verifies", flush=True)
    assert median < LIMIT_S, "gaze takes too long"


def check_restarts(tomcom, folder, times=10):
    """Capture is killed and started again ten times in one trial, and sends wild things besides."""
    surface, places = kitchen(tomcom)
    port = PORT + 1
    path = session(folder, port)
    stand_ins = []
    with Console(tomcom, [path, "--out", folder / "recordings"]) as console:
        for round_ in range(times + 1):
            stand_ins.append(StandIn(folder, port, surface, places, "--wild"))
            stand_ins[-1].wait_for("began")
            console.wait_for(r"gaze +\d\d\d? Hz")
            if round_ == 0:
                start_trial(console)
            time.sleep(1.0)
            stand_ins[-1].kill()
            console.wait_for("NO TRACKER")
            assert "RUNNING" in console.text()
        console.end()
        console.quit()
    (recording,) = (folder / "recordings").iterdir()
    events = recorded(recording)
    trackers = [event for event in events if event["kind"] == "tracker"]
    what = lambda name: [event for event in trackers if event["what"] == name]
    assert len(what("connected")) == len(what("lost")) == times + 1, (len(what("connected")), len(what("lost")))
    gaze = [event for event in events if event["kind"] == "gaze"]
    for stand_in in stand_ins:
        sent = {round(note["t"] * 1e9) // 1000 for note in stand_in.notes("sample")}
        arrived = {event["device_ns"] // 1000 for event in gaze}
        # What was on its way when it was killed may be lost.
        near = sum(any(t + by in arrived for by in (-1, 0, 1)) for t in sent)
        assert near >= len(sent) - 16, f"{near} of {len(sent)} arrived"
    recordings = [sum(note["request"] == f"R {recording.name}" for note in one.notes("request")) for one in stand_ins]
    assert all(count >= 1 for count in recordings), f"Capture records on after each restart: {recordings}"
    shown = subprocess.run([tomcom, "replay", recording, "--format", "json"], capture_output=True, check=True)
    counted = json.loads(shown.stdout)["gaze"]
    for kind in ("malformed", "duplicate", "too_old", "out_of_order"):
        assert counted[kind] > times, (kind, counted)
    assert counted["samples"] == len(gaze) and counted["losses"] == times + 1, counted
    verify(tomcom, recording)
    presses = sum(event["kind"] == "press" for event in events)
    print(
        f"Pupil killed and restarted {times} times in one trial: {len(gaze)} samples, {presses} presses, "
        f"{', '.join(f'{counted[kind]} {kind}' for kind in ('malformed', 'duplicate', 'too_old', 'out_of_order'))} "
        f"counted; the recording verifies", flush=True)


def check_fast(tomcom, folder, seconds):
    """A thousand samples a second; what the assistant takes meanwhile, with and without."""
    surface, places = kitchen(tomcom)
    advice = {}
    for source, fps in (("simulated", 0), ("pupil", 100)):
        here = folder / source
        port = PORT + 2
        stand_in = StandIn(here, port, surface, places, "--fps", fps, "--samples", 10, "--seconds", seconds) if fps else None
        path = session(here, port, gaze=source)
        with Console(tomcom, [path, "--out", here / "recordings"]) as console:
            console.wait_for("READY")
            if stand_in:
                stand_in.wait_for("began")
                console.wait_for(r"gaze +\d{3,4} Hz")
            start_trial(console)
            cpu_s, began = console.cpu_s(), time.monotonic()
            keys = []
            while time.monotonic() < began + min(seconds, 60):
                key, note = NOTES[len(keys) % 2]
                console.watch(lambda rows: any(f"note recorded: {note}" in row for row in rows))
                pressed = time.monotonic()
                console.key(key)
                while console.drawn is None and time.monotonic() < pressed + 5:
                    time.sleep(0.001)
                keys.append((console.drawn or pressed + 5) - pressed)
                time.sleep(1.5)
            share = (console.cpu_s() - cpu_s) / (time.monotonic() - began)
            if stand_in:
                stand_in.wait_for("ended", seconds + 120)
                time.sleep(1)
            console.quit()
        (recording,) = (here / "recordings").iterdir()
        events = recorded(recording)
        times = {event["seq"]: event["t_ns"] for event in events}
        late = [(event["t_ns"] - times[event["for_seq"]]) / 1e9 for event in events if event["kind"] == "advised"]
        advice[source] = (percentile(late, 0.5), percentile(late, 0.99), percentile(keys, 0.5), max(keys), share)
        if stand_in:
            latencies = compare(stand_in.notes("sample"), [e for e in events if e["kind"] == "gaze"], surface, places)
            dropped = [event for event in events if event["kind"] == "tracker" and event["what"] == "dropped"]
            stand_in.kill()
            verify(tomcom, recording)
            print(f"Pupil at 1000 Hz for {seconds} s: {len(latencies)} samples, none lost, {len(dropped)} counts of drops; "
                  f"p50 {1000 * percentile(latencies, 0.5):.2f} ms, p99 {1000 * percentile(latencies, 0.99):.1f} ms", flush=True)
    for source, (median, p99, key, worst, share) in advice.items():
        print(f"  {source} gaze: advice p50 {1000 * median:.0f} ms, p99 {1000 * p99:.0f} ms; key to screen p50 "
              f"{1000 * key:.0f} ms, most {1000 * worst:.0f} ms; {100 * share:.0f} % of a core", flush=True)
        assert key < 0.1, "keys take too long"


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("--seconds", type=float, default=20, help="of a session at 30 frames a second")
    asked.add_argument("--fast-seconds", type=float, default=20, help="of one at 1,000 samples a second")
    asked.add_argument("--only", choices=["session", "restarts", "fast"])
    options = asked.parse_args()
    if options.only in (None, "session"):
        check_session(options.tomcom, options.folder / "session", options.seconds, "sushi")
        check_session(options.tomcom, options.folder / "burger", options.seconds / 2, "burger")
    if options.only in (None, "restarts"):
        check_restarts(options.tomcom, options.folder / "restarts")
    if options.only in (None, "fast"):
        check_fast(options.tomcom, options.folder / "fast", options.fast_seconds)
