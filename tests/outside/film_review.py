"""Films beside a recording that is reviewed: the player mpv follows `tomcom replay`, as asked over its own socket; and the stream
for Rerun has the film and its frames in step, as Rerun's reader reads it.

    tests/outside/film_review.py TOMCOM FOLDER
"""

import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

from console import Console
from rerun.experimental import RrdReader
from simulated import recordings_in, run

AHEAD_S, RATE = 6.5, 25
# mpv without a screen, which tells with what it was started.
PLAYER = """#!/bin/sh
printf '%s\\n' "$@" > "{told}"
exec "{mpv}" --no-config --vo=null --ao=null "$@"
"""


class Mpv:
    """The player that the program started, asked over a connection of our own."""

    def __init__(self, told):
        until = time.monotonic() + 60
        while True:
            arguments = told.read_text().splitlines() if told.exists() else []
            path = next((word.split("=", 1)[1] for word in arguments if word.startswith("--input-ipc-server=")), None)
            if path and os.path.exists(path):
                break
            assert time.monotonic() < until, "no player was started"
            time.sleep(0.05)
        self.film = arguments[-1]
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(path)
        self.file, self.number = self.socket.makefile("rw"), 0

    def ask(self, name):
        self.number += 1
        self.file.write(json.dumps({"command": ["get_property", name], "request_id": self.number}) + "\n")
        self.file.flush()
        while True:
            answer = json.loads(self.file.readline())
            if answer.get("request_id") == self.number and "error" in answer:
                return answer.get("data")

    def wait_for(self, name, fits, what, seconds=60):
        until = time.monotonic() + seconds
        while True:
            value = self.ask(name)
            if value is not None and fits(value):
                return value
            assert time.monotonic() < until, f"{what}: {name} is {value}"
            time.sleep(0.05)


def recorded(tomcom, folder):
    run(tomcom, "simulate", "sessions/default.toml", "--trials", 1, "--seed", 7, "--arm", "timed", "--out", folder / "recordings")
    (recording,) = recordings_in(folder / "recordings")
    events = [json.loads(line) for line in (recording / "events.jsonl").read_text().splitlines()[1:]]
    length_s = events[-1]["t_ns"] / 1e9 + AHEAD_S + 5
    film = folder / "room.mp4"
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-f", "lavfi", "-i", f"testsrc=size=160x90:rate={RATE}:duration={length_s}", "-c:v", "libx264",
                    "-preset", "ultrafast", "-g", str(RATE), film], check=True)
    run(tomcom, "video", "attach", recording, film, "--offset", AHEAD_S)
    return recording, events, film


def follows(tomcom, folder, recording, events, film):
    tools, told = folder / "tools", folder / "mpv-arguments"
    tools.mkdir(exist_ok=True)
    told.unlink(missing_ok=True)
    (tools / "mpv").write_text(PLAYER.format(told=told.resolve(), mpv=shutil.which("mpv")))
    (tools / "mpv").chmod(0o755)
    os.environ.update(PATH=f"{tools.resolve()}:{os.environ['PATH']}", DISPLAY=os.environ.get("DISPLAY", ":99"))
    started_s = next(event["t_ns"] for event in events if event["kind"] == "trial_started") / 1e9
    with Console(tomcom, [recording], command="replay") as console:
        mpv = Mpv(told)
        assert mpv.film == str(film.resolve()), mpv.film
        # The first jump waits until the whole recording is read.
        console.key("\x1b[H")
        mpv.wait_for("time-pos", lambda at: abs(at - AHEAD_S) <= 0.1, "the beginning")
        console.key("e")
        errors = run(tomcom, "codes", recording, "--format", "json")
        assert json.loads(errors)["recordings"][0]["errors"] >= 3
        run(tomcom, "export", recording, "--vtt")
        times_s = [sum(float(part) * 60 ** power for power, part in enumerate(reversed(found.split(":"))))
                   for found in re.findall(r"(\S+) --> \S+\nerrors: ", (recording / "recording.vtt").read_text())]
        mpv.wait_for("pause", lambda paused: paused, "a jump pauses")
        for number, error_s in enumerate(times_s[:3], 1):
            if number > 1:
                console.key("e")
                console.wait_for(rf"error {number} of \d+")
            found_s = mpv.wait_for("time-pos", lambda at: abs(at - error_s) <= 1.5 / RATE, f"error {number} at {error_s:.2f} s of the film")
            print(f"error {number}: the film stands at {found_s:.2f} s, the press is at {error_s:.2f} s", flush=True)
        console.key(".")
        mpv.wait_for("pause", lambda paused: not paused, "it plays")
        console.key("+")
        mpv.wait_for("speed", lambda speed: 1.5 < speed < 2.5, "twice as fast")
        console.key("-")
        mpv.wait_for("speed", lambda speed: 0.7 < speed < 1.3, "as fast again")
        time.sleep(3)
        console.key(".")
        mpv.wait_for("pause", lambda paused: paused, "it stands")
        time.sleep(1)
        clock = [int(number) for number in re.search(r"(\d+):(\d\d)", console.text()).groups()]
        told_s = 60 * clock[0] + clock[1] + started_s + AHEAD_S
        mpv.wait_for("time-pos", lambda at: -0.1 <= at - told_s <= 1.1, f"the console's clock says {told_s:.1f} s of the film")
        console.key("\x1b[H")
        mpv.wait_for("time-pos", lambda at: abs(at - AHEAD_S) <= 0.1 + started_s, "the beginning")
        console.quit() if "Quit" in console.text() else console.key("\x03")
        assert console.process.wait(30) == 0
    until = time.monotonic() + 10
    while subprocess.run(["pgrep", "-f", str(film.resolve())], capture_output=True).stdout:
        assert time.monotonic() < until, "the player outlives the replay"
        time.sleep(0.1)
    print("mpv follows jumps, pauses and speeds of tomcom replay, and ends with it", flush=True)


def streams(tomcom, folder, recording, events, film):
    """The stream has the film, and at each time the frame of then."""
    saved = folder / "review.rrd"
    saved.unlink(missing_ok=True)
    told = run(tomcom, "review", recording, f"--save={saved}")
    assert "not shown" not in told, told
    frames, has_film = [], False
    for chunk in RrdReader(saved).stream():
        if str(chunk.entity_path).strip("/") != "films/1":
            continue
        batch = chunk.to_record_batch()
        names = batch.schema.names
        if chunk.is_static:
            (blob,) = [name for name in names if name.endswith("blob")]
            content = batch.column(blob).to_pylist()[0][0]
            has_film = bytes(content) == film.read_bytes()
            continue
        (shown,) = [name for name in names if name.endswith("timestamp")]
        times = batch.column("session_time").cast("int64").to_pylist()
        frames += [(time_ns, value[0]) for time_ns, value in zip(times, batch.column(shown).to_pylist())]
    assert has_film and frames, "no film in the stream"
    assert all(abs(film_ns - session_ns - AHEAD_S * 1e9) < 1e3 for session_ns, film_ns in frames), frames[:3]
    last_s = events[-1]["t_ns"] / 1e9
    assert abs(frames[-1][0] / 1e9 - last_s) < 0.1 and frames[0][0] / 1e9 < 0.1, (frames[0], frames[-1], last_s)
    # Beside the log there is no film; another kind of film is named.
    run(tomcom, "review", recording, "--save")
    assert (recording / "recording.rrd").stat().st_size < saved.stat().st_size - film.stat().st_size / 2
    other = folder / "room.mkv"
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", film, "-c", "copy", other], check=True)
    run(tomcom, "video", "attach", recording, other, "--offset", AHEAD_S)
    told = run(tomcom, "review", recording, f"--save={saved}")
    assert "not shown: " in told and "room.mkv: Rerun plays MP4" in told, told
    print(f"Rerun's reader: the film, and {len(frames)} frames in step", flush=True)


def main():
    tomcom, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    recording, events, film = recorded(tomcom, folder)
    streams(tomcom, folder, recording, events, film)
    (recording / "video.json").unlink()
    run(tomcom, "video", "attach", recording, film, "--offset", AHEAD_S)
    if shutil.which("mpv"):
        follows(tomcom, folder, recording, events, film)
    else:
        print("mpv cannot be had here: its window beside the replay is not looked at", flush=True)


if __name__ == "__main__":
    main()
