"""The Lab Streaming Layer from outside: pylsl sends gaze to a live session and reads its streams, LabRecorder's own code records all of
them into XDF in a process of its own, and pyxdf reads that file.

    lsl.py TOMCOM FOLDER [--seconds 60] [--hz 200]
"""

import atexit
import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy
import pylsl.lib
import pyxdf

from console import Console, Log, parser, recorded, verify
from latency import SIGNALS, send

LIBRARY = pylsl.lib.libpath
OUTLETS = ["markers", "events", "presses", "beliefs", "net_benefit", "gaze", "arm"]
SIZE = (1920, 1080)
# Between two clocks of one computer, in seconds.
OFF_S = 0.001

# Sends gaze in pixels from the bottom left, among other channels; a line for each sample goes to the journal.
TRACKER = """
import json, math, sys, time
import pylsl
name, hz, journal, source, rate = sys.argv[1], float(sys.argv[2]), open(sys.argv[3], "a", buffering=1), sys.argv[4], float(sys.argv[5])
info = pylsl.StreamInfo(name, "Gaze", 4, hz, "float32", source)
channels = info.desc().append_child("channels")
for label in ("pupil", "left_x", "left_y", "quality"):
    channels.append_child("channel").append_child_value("label", label)
outlet, begun, sent, first = pylsl.StreamOutlet(info), time.monotonic(), 0, pylsl.local_clock()
while True:
    while sent <= (time.monotonic() - begun) * hz:
        # A sender that counts its samples stamps them by the rate that it assumes.
        stamp = pylsl.local_clock() if rate == 1 else first + rate * sent / hz
        x, y = 960 + 800 * math.cos(sent / 97), 540 + 400 * math.sin(sent / 61)
        # Eyes that are closed: no gaze.
        seen = float("nan") if sent % 1000 >= 970 else x
        outlet.push_sample([3.5, seen, y, 0.9], stamp)
        journal.write(json.dumps([stamp, seen, y, outlet.have_consumers()]) + "\\n")
        sent += 1
    time.sleep(0.5 / hz)
"""

# Records what these predicates find until a line comes.
RECORDER = """
import sys
import labrecorder
recording = labrecorder.Recording(sys.argv[1], [], sys.argv[2:])
sys.stdin.readline()
recording.stop()
"""


def session(folder, condition="assistant", gaze=True, library=LIBRARY, channel="left_x", more=""):
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "session.toml"
    layout = Path("layouts/sushi.toml").resolve()
    source = "lsl" if gaze else "simulated"
    text = (
        f'layout = "{layout}"\nseed = 9761\n[trial]\ncondition = "{condition}"\npresses = 4000000000\nseconds = 86400.0\n'
        f'[signals]\ncool_down_s = 0.0\n[participant]\ncode = "L7"\nkind = "simulated"\ngaze = "{source}"\n[robot]\narm = "physics"\n[rerun]\nlive = false\nrecord = false\n'
        f'[lsl]\nlibrary = "{library}"\noutlets = {json.dumps(OUTLETS)}\n'
    )
    if gaze:
        text += (
            f'[lsl.gaze]\nname = "tracker"\nx = "{channel}"\ny = "left_y"\nconfidence = "quality"\nunit = "pixels"\n'
            f'size = [{SIZE[0]}, {SIZE[1]}]\norigin = "bottom_left"\n{more}'
        )
    path.write_text(text)
    return path


def tracker(folder, hz=200, name="tracker", source="tracker-1", rate=1):
    journal = folder / f"{name}.jsonl"
    command = [sys.executable, "-c", TRACKER, name, str(hz), journal, source, str(rate)]
    sender = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    atexit.register(sender.kill)
    return sender, journal


def begin(tomcom, folder, **settings):
    console = Console(tomcom, [session(folder, **settings), "--out", folder / "recordings"])
    console.wait_for("READY")
    (recording,) = (folder / "recordings").iterdir()
    return console, recording


class Recorder:
    """LabRecorder's code, in a process of its own."""

    def __init__(self, file, predicates):
        self.told = file.with_suffix(".txt")
        with open(self.told, "wb") as out:
            command = ["stdbuf", "-o0", sys.executable, "-c", RECORDER, file, *predicates]
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=out, stderr=subprocess.DEVNULL)

    def wait_for(self, streams, seconds=60):
        until = time.monotonic() + seconds
        while len(set(re.findall(r"Started data collection for stream (\S+)\.", self.told.read_text()))) < streams:
            assert self.process.poll() is None, self.told.read_text()
            assert time.monotonic() < until, self.told.read_text()
            time.sleep(0.2)

    def stop(self):
        self.process.communicate(b"\n", timeout=60)
        assert self.process.returncode == 0, self.told.read_text()


def streams_of(file):
    streams, _ = pyxdf.load_xdf(file, dejitter_timestamps=False)
    found = {}
    for stream in streams:
        source = stream["info"]["source_id"][0].split("-")
        found[source[-1] if source[0] == "tomcom" else stream["info"]["name"][0]] = stream
    return found


def labels(stream):
    return [channel["label"][0] for channel in stream["info"]["desc"][0]["channels"][0]["channel"]]


def texts(stream):
    return [sample[0] for sample in stream["time_series"]]


def without(event, fields):
    return {name: value for name, value in event.items() if name not in fields}


def check_events(streams, events):
    """Every event is among the markers, as the log has it; LSL's time less the log's is the same for all."""
    told = [(stamp, json.loads(text)) for stamp, text in zip(streams["events"]["time_stamps"], texts(streams["events"]))]
    told = [(stamp, event) for stamp, event in told if event["kind"] != "recording"]
    first = told[0][1]["seq"]
    wanted = [event for event in events if event["seq"] >= first and event["kind"] not in ("gaze", "robot_moves")]
    assert [event["seq"] for _, event in told] == [event["seq"] for event in wanted], (len(told), len(wanted))
    assert {"trial_started", "press", "belief_estimated", "session_ended"} <= {event["kind"] for event in wanted}
    for (_, event), logged in zip(told, wanted):
        left_out = event.pop("left_out", [])
        assert event == without(logged, left_out), (event, logged)
    offsets = numpy.array([stamp - event["t_ns"] / 1e9 for stamp, event in told])
    assert numpy.ptp(offsets) < OFF_S, f"events are up to {1000 * numpy.ptp(offsets):.3f} ms off"
    codes = zip(streams["markers"]["time_stamps"], texts(streams["markers"]))
    codes = [(stamp, code) for stamp, code in codes if not code.startswith("recording/")][-len(told):]
    for (stamp, code), (at, event) in zip(codes, told):
        assert code.split("/")[0] == event["kind"] and abs(stamp - at) < OFF_S, (code, event)
        if event["kind"] == "press":
            assert code == f"press/{event['agent']}/{event['button']}", code
    return first, float(numpy.median(offsets)), numpy.ptp(offsets), len(told)


def near(stamps, times_s, offset_s, what):
    assert len(stamps) == len(times_s) > 0, (what, len(stamps), len(times_s))
    off_s = numpy.abs(numpy.asarray(stamps) - numpy.asarray(times_s) - offset_s).max()
    assert off_s < OFF_S, f"{what}: up to {1000 * off_s:.3f} ms off"
    return off_s


def tail(stream, events):
    """The last samples, as many as there are events: what came before the recorder was there is in the log only."""
    count = min(len(stream["time_stamps"]), len(events))
    return stream["time_stamps"][-count:], stream["time_series"][-count:], events[-count:]


def check_samples(streams, events, first, offset_s):
    events = [event for event in events if event["seq"] >= first]
    kinds = lambda kind: [event for event in events if event["kind"] == kind]
    stamps, values, gaze = tail(streams["gaze"], kinds("gaze"))
    assert len(gaze) == len(kinds("gaze")), (len(gaze), len(kinds("gaze")))
    near(stamps, [event.get("taken_ns", event["t_ns"]) / 1e9 for event in gaze], offset_s, "gaze")
    assert all(abs(sample[0] - event["x"]) < 1e-9 and abs(sample[2] - event["confidence"]) < 1e-9 for sample, event in zip(values, gaze))
    stamps, values, moves = tail(streams["arm"], kinds("robot_moves"))
    near(stamps, [event["t_ns"] / 1e9 for event in moves], offset_s, "arm")
    assert len(moves) == len(kinds("robot_moves")) and numpy.array_equal(values, [event["joints"] for event in moves])
    stamps, values, presses = tail(streams["presses"], kinds("press"))
    near(stamps, [event.get("at_ns", event["t_ns"]) / 1e9 for event in presses], offset_s, "presses")
    assert len(presses) == len(kinds("press")) > 10
    assert [sample[:2] for sample in values] == [[event["agent"], event["button"]] for event in presses]
    assert {sample[2] for sample in values} <= {"yes", "no"} and all((sample[3] == "") == (sample[0] == "robot") for sample in values)
    stamps, values, advised = tail(streams["net_benefit"], kinds("advised"))
    near(stamps, [event["for_ns"] / 1e9 for event in advised], offset_s, "net benefit")
    names = labels(streams["net_benefit"])
    for sample, event in zip(values, advised):
        nets = {f"{kind}/{place}": option["net"] for option in event["options"] for kind, place in option["signal"].items()}
        told = {name: value for name, value in zip(names, sample) if not math.isnan(value)}
        assert told == nets, (told, nets)
    beliefs = streams["beliefs"]
    assert ((beliefs["time_series"] >= 0) & (beliefs["time_series"] <= 1)).all() and len(beliefs["time_stamps"]) > len(kinds("press"))
    check_beliefs(beliefs, kinds("belief_estimated"), offset_s)
    return len(gaze), len(moves)


def check_beliefs(stream, estimated, offset_s):
    """Just before a press the stream has what the log has of the estimate before it."""
    names, off = labels(stream), []
    for event in estimated:
        before = numpy.searchsorted(stream["time_stamps"], event["t_ns"] / 1e9 + offset_s - 1e-6) - 1
        if before >= 0:
            row = stream["time_series"][before]
            off += [abs(row[names.index(about["aspect"])] - about["p_truth"]) for about in event["aspects"]]
    assert len(off) > 100 and numpy.median(off) < 0.02, (len(off), numpy.median(off))


def check_gaze(journal, events, streams):
    """What the tracker sent is in the log: each sample but those of closed eyes, on the display, with its own time."""
    sent = [json.loads(line) for line in journal.read_text().splitlines()]
    gaze = [event for event in events if event["kind"] == "gaze"]
    by_stamp = {int(stamp * 1e9): (stamp, x, y) for stamp, x, y, _ in sent}
    stamps = [event["device_ns"] for event in gaze]
    assert len(set(stamps)) == len(stamps) and stamps == sorted(stamps)
    for stamp, event in zip(stamps, gaze):
        _, x, y = by_stamp[stamp]
        assert abs(event["x"] - x / SIZE[0]) < 2e-5 and abs(event["y"] - (1 - y / SIZE[1])) < 2e-5, (event, x, y)
    seen = [int(stamp * 1e9) for stamp, x, _, _ in sent if not math.isnan(x) and stamps[0] <= int(stamp * 1e9) <= stamps[-1]]
    assert seen == stamps, f"{len(seen)} sent, {len(stamps)} recorded"
    # From the tracker's stamp to the stamp of our own stream: two ways through liblsl, one clock.
    out = streams["gaze"]["time_stamps"]
    sent_s = numpy.array([by_stamp[stamp][0] for stamp in stamps[-len(out):]])
    off_s = numpy.abs(out - sent_s[-len(out):]).max()
    assert off_s < OFF_S, f"gaze went in and out with {1000 * off_s:.3f} ms"
    return len(stamps), off_s


def check_metadata(streams):
    units = {name: {channel["unit"][0] for channel in streams[name]["info"]["desc"][0]["channels"][0]["channel"]} for name in OUTLETS}
    assert units["beliefs"] == {"probability"} and units["net_benefit"] == {"presses"} and units["arm"] == {"radians"}, units
    assert labels(streams["gaze"]) == ["x", "y", "confidence"] and len(labels(streams["arm"])) == 6
    for name in OUTLETS:
        info = streams[name]["info"]
        assert info["name"] == [f"tomcom-{name}-L7"] and info["source_id"] == [f"tomcom-L7-{name}"], info
        layout = info["desc"][0]["layout"][0]
        assert layout["name"] == ["sushi"] and float(layout["display_width_m"][0]) > 0
        assert "cooking_pot" in [location["name"][0] for location in layout["locations"][0]["location"]]


def check_both_ways(tomcom, folder, seconds, hz):
    folder.mkdir(parents=True)
    sender, journal = tracker(folder, hz)
    console, recording = begin(tomcom, folder)
    consumer = None
    try:
        with console:
            recorder = Recorder(folder / "session.xdf", ["starts-with(source_id,'tomcom-')", "name='tracker'"])
            recorder.wait_for(len(OUTLETS) + 1)
            with open(folder / "consumer.txt", "wb") as told:
                command = [sys.executable, "examples/lsl_consumer.py"]
                consumer = subprocess.Popen(command, stdout=told, stderr=subprocess.DEVNULL)
            console.start()
            time.sleep(seconds)
            console.quit()
            time.sleep(1)
            recorder.stop()
    finally:
        sender.kill()
        if consumer:
            consumer.kill()
            consumer.wait()
    check_recorded(tomcom, folder, recording, journal, f"LSL for {seconds} s at {hz} Hz")


def check_recorded(tomcom, folder, recording, journal, title):
    """What a session and its recorder left behind."""
    verify(tomcom, recording)
    events, streams = recorded(recording), streams_of(folder / "session.xdf")
    assert set(streams) == {*OUTLETS, "tracker"}, set(streams)
    check_metadata(streams)
    first, offset_s, spread_s, told = check_events(streams, events)
    gaze, moves = check_samples(streams, events, first, offset_s)
    sent, off_s = check_gaze(journal, events, streams)
    printed = (folder / "consumer.txt").read_text()
    presses = [event for event in events if event["kind"] == "press"]
    assert printed.count(" press/") > 0.8 * len(presses) and "session_ended" in printed and "has ended" in printed, printed[-500:]
    check_example(folder / "session.xdf", recording, streams)
    print(
        f"{title}: {told} events, {gaze} gaze samples and {moves} of the arm in the XDF file, none lost, times within "
        f"{1000 * spread_s:.3f} ms; {sent} samples of the tracker, in and out again within {1000 * off_s:.3f} ms; the recording verifies",
        flush=True,
    )


def check_example(file, recording, streams):
    done = subprocess.run([sys.executable, "examples/read_xdf.py", file], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    human = [sample for sample in streams["presses"]["time_series"] if sample[0] == "human"]
    assert f"presses_human: {len(human)}\n" in done.stdout and f"recording: {recording.name}\n" in done.stdout, done.stdout
    assert f"errors_human: {sum(sample[3] == 'yes' for sample in human)}\n" in done.stdout and "gaze_before_press" in done.stdout, done.stdout


def check_tracker_comes_and_goes(tomcom, folder):
    """A tracker that is killed and comes back, and one without the channel that the session names."""
    console, recording = begin(tomcom, folder)
    with console:
        console.wait_for("NO TRACKER")
        console.key(".")
        console.wait_for("no stream .tracker.")
        sender, _ = tracker(folder)
        console.wait_for("tracker on ")
        console.key("\x1b")
        console.start()
        time.sleep(3)
        sender.kill()
        console.wait_for("NO TRACKER")
        sender, _ = tracker(folder)
        console.wait_for(r"gaze \d+ Hz")
        time.sleep(2)
        console.quit()
        sender.kill()
    what = [event["what"] for event in recorded(recording, "tracker") if event["what"] in ("connected", "lost")]
    assert what == ["connected", "lost", "connected"], what
    verify(tomcom, recording)
    sender, _ = tracker(folder)
    console, _ = begin(tomcom, folder / "channel", channel="gaze_x")
    with console:
        console.key(".")
        console.wait_for("no channel .gaze_x.; it has pupil")
        console.key("\x1b")
        done = subprocess.run([tomcom, "doctor", folder / "channel" / "session.toml"], capture_output=True, text=True)
        assert "liblsl 1." in done.stdout and "left_x, left_y, quality" in done.stdout, done.stdout
        console.quit()
    sender.kill()
    print("a tracker that comes, goes and comes back is told each time; a channel that is missing is told with those that there are", flush=True)


def check_two_of_one_name(tomcom, folder):
    """Two streams of one name: neither is taken until the session file chooses, and both are named."""
    folder.mkdir(parents=True)
    senders = [tracker(folder, source=source)[0] for source in ("tracker-1", "tracker-2")]
    time.sleep(1)
    console, recording = begin(tomcom, folder)
    with console:
        console.wait_for("NO TRACKER")
        console.key(".")
        console.wait_for("2 streams .tracker.")
        console.key("\x1b")
        done = subprocess.run([tomcom, "doctor", folder / "session.toml"], capture_output=True, text=True)
        told = " ".join(done.stdout.split())
        assert done.returncode == 1 and "2 LSL streams" in told and 'source_id "tracker-1"' in told and 'source_id "tracker-2"' in told, told
        console.key("3")  # a session in which nothing happened leaves no recording
        console.quit()
    events = recorded(recording)
    (several,) = [event["streams"] for event in events if event["kind"] == "tracker" and event["what"] == "several_streams"]
    assert len(several) == 2 and not any(event["kind"] == "gaze" for event in events), several
    host = re.search(r" on (\S+), source_id", several[0])[1]
    for number, more in enumerate(['source_id = "tracker-2"\n', f'source_id = "tracker-1"\nhost = "{host}"\n']):
        console, recording = begin(tomcom, folder / f"chosen-{number}", more=more)
        with console:
            console.wait_for(r"gaze \d+ Hz")
            time.sleep(1)
            console.quit()
        events = recorded(recording)
        late = [event for event in events if event["kind"] == "gaze" and event["t_ns"] - event["taken_ns"] > 0.5e9]
        assert not late and not any(event.get("what") == "several_streams" for event in events), len(late)
    # The second one comes when the first one is read: that is told, and the first one is read on.
    senders.pop().kill()
    time.sleep(5)
    console, recording = begin(tomcom, folder / "later")
    with console:
        console.wait_for(r"gaze \d+ Hz")
        senders.append(tracker(folder, source="tracker-3")[0])
        console.wait_for("2 gaze streams fit the settings")
        console.wait_for(r"gaze \d+ Hz")
        console.quit()
    for sender in senders:
        sender.kill()
    verify(tomcom, recording)
    print("two streams of one name: refused and named by doctor and checks, chosen by source_id and host, and told when the second one comes later", flush=True)


def check_stamps(tomcom, folder):
    """A sender that stamps its samples by a rate that it does not keep: told, and stamped by arrival."""
    folder.mkdir(parents=True)
    sender, _ = tracker(folder, rate=0.97)
    console, recording = begin(tomcom, folder)
    with console:
        console.wait_for("t runs at 97 % of real time")
        time.sleep(10)
        console.quit()
    sender.kill()
    events = recorded(recording)
    gaze = [event for event in events if event["kind"] == "gaze"]
    told = [event for event in events if event["kind"] == "tracker" and event["what"] == "stamps"]
    late = [event for event in gaze if event["t_ns"] - event["taken_ns"] > 0.5e9]
    assert len(told) == 1 and told[0]["t_ns"] - gaze[0]["t_ns"] < 5e9 and len(gaze) > 1000 and not late, (told, len(late))
    verify(tomcom, recording)
    print(f"stamps of a sender that is slower by 3 %: told after {(told[0]['t_ns'] - gaze[0]['t_ns']) / 1e9:.1f} s, none of {len(gaze)} samples late", flush=True)


def check_stopped_reader(tomcom, folder):
    """A reader that is stopped delays no key: signals are in the log as soon as without it."""
    console, recording = begin(tomcom, folder, condition="wizard", gaze=False)
    reader = subprocess.Popen([sys.executable, "examples/lsl_consumer.py"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    try:
        with console:
            assert b"tomcom-markers" in reader.stdout.readline()
            console.start()
            time.sleep(2)
            reader.send_signal(signal.SIGSTOP)
            log, took = Log(recording), []
            for key in list(SIGNALS)[:6] * 3:
                time.sleep(0.4)
                took.append(send(console, log, key, SIGNALS[key])[0])
            console.quit()
    finally:
        reader.kill()
    verify(tomcom, recording)
    assert sorted(took)[len(took) // 2] < 0.05, took
    print(f"a reader that is stopped: {len(took)} signals in the log after {1000 * sorted(took)[len(took) // 2]:.1f} ms (median)", flush=True)


def check_no_library(tomcom, folder):
    path = session(folder, library=folder / "liblsl.so")
    done = subprocess.run([tomcom, "operate", path, "--out", folder / "recordings"], capture_output=True, text=True)
    told = " ".join(done.stderr.split())
    assert done.returncode != 0 and "liblsl" in told and "pip install pylsl" in told, told
    assert not (folder / "recordings").exists(), "nothing is recorded"
    done = subprocess.run([tomcom, "doctor", path], capture_output=True, text=True)
    assert re.search(r"FAILED +lsl .*liblsl", done.stdout) and done.returncode == 1, done.stdout
    print("without its library a session with LSL does not begin, and says where to get it", flush=True)


if __name__ == "__main__":
    options = parser(__doc__)
    options.add_argument("--seconds", type=int, default=60)
    options.add_argument("--hz", type=int, default=200)
    arguments = options.parse_args()
    program, scratch = str(Path(arguments.tomcom).resolve()), arguments.folder.resolve() / str(os.getpid())
    check_no_library(program, scratch / "none")
    check_tracker_comes_and_goes(program, scratch / "comes")
    check_two_of_one_name(program, scratch / "two")
    check_stamps(program, scratch / "stamps")
    check_stopped_reader(program, scratch / "stopped")
    check_both_ways(program, scratch / "both", arguments.seconds, arguments.hz)
