"""Runs the examples in Python and R that read recordings and tables, and computes what they print once more.

    examples.py TOMCOM SCRATCH

The R scripts run where R is installed (Debian: r-base-core, r-cran-jsonlite); where it is not, that is said.
"""

import csv
import json
import os
import shutil
import statistics
import subprocess
import sys
from collections import Counter
from pathlib import Path

from simulated import run, shortened

SESSION = Path("sessions/paper.toml")


def simulate(tomcom, folder):
    session = shortened(SESSION, folder / "study.toml", 60)
    run(tomcom, "simulate", session, "--trials", 8, "--seed", 11, "--out", folder / "recordings")
    recordings = sorted(path for path in (folder / "recordings").iterdir() if path.is_dir())
    run(tomcom, "exclude", recordings[-1], "--reason", "asked for it")
    run(tomcom, "study", folder / "recordings", "--out", folder / "study", "--skip", "concepts")
    return recordings


def pause(recording):
    """Puts a pause of two seconds into the trial, by the log's own events; what follows is two seconds later."""
    with open(recording / "events.jsonl", encoding="utf-8") as log:
        header, *events = map(json.loads, log)
    at = len(events) // 2
    at = next(place for place in range(at, len(events)) if events[place]["kind"] == "gaze")
    now = events[at]["t_ns"]
    for event in events[at:]:
        event["t_ns"] += 2 * 10**9
    events[at:at] = [{"seq": 0, "t_ns": now, "kind": "trial_paused"}, {"seq": 0, "t_ns": now + 2 * 10**9, "kind": "trial_resumed"}]
    for number, event in enumerate(events):
        event["seq"] = number
    paused = recording.with_name("paused")
    paused.mkdir()
    (paused / "events.jsonl").write_text("".join(json.dumps(line) + "\n" for line in (header, *events)))
    return paused


def split(recording):
    """The same recording in two parts: the first one cut, the second one continues it. The folder of the second one."""
    lines = (recording / "events.jsonl").read_text().splitlines()
    at = len(lines) // 2
    first, second = recording.parent / "cut" / "cut", recording.parent / "cut" / "cut-part2"
    for folder in (first, second):
        folder.mkdir(parents=True)
    # A cut log can end in the middle of a line.
    (first / "events.jsonl").write_text("\n".join(lines[:at]) + "\n" + lines[at][:20])
    begins = json.loads(lines[at - 1])
    header = json.loads(lines[0]) | {"continues": {"recording": "cut", "events": begins["seq"] + 1, "t_ns": begins["t_ns"]}}
    (second / "events.jsonl").write_text("\n".join([json.dumps(header), *lines[at:]]) + "\n")
    return second


def figures(text):
    return {key: value.strip() for key, value in (line.split(": ", 1) for line in text.splitlines())}


def expected(recording):
    """The same by other means: counts from the log's lines, times from the program."""
    lines = (recording / "events.jsonl").read_text().splitlines()
    header, events = json.loads(lines[0]), [json.loads(line) for line in lines[1:]]
    kinds = Counter(event["kind"] for event in events)
    human = [event for event in events if event["kind"] == "press" and event["agent"] == "human"]
    gaze = [event for event in events if event["kind"] == "gaze" and event["confidence"] >= 0.6]
    clock = trial_times(events)
    between = [later - earlier for earlier, later in zip(human, human[1:]) for earlier, later in [(clock[earlier["seq"]], clock[later["seq"]])]]
    buttons = Counter(event["button"] for event in human)
    most = max(buttons.values())
    return {
        "participant": header["session"]["participant"]["code"],
        "condition": header["session"]["trial"]["condition"],
        "events": len(events),
        "trial_s": max(clock.values()),
        "presses_human": len(human),
        "presses_robot": kinds["press"] - len(human),
        "signals": kinds["signal_shown"],
        "orders": kinds["order_shown"],
        "median_s_between_presses": statistics.median(between),
        "most_pressed": {button for button, count in buttons.items() if count == most},
        "gaze_samples": kinds["gaze"],
        "gaze_on_display": sum(0 <= event["x"] <= 1 and 0 <= event["y"] <= 1 for event in gaze) / len(gaze),
    }


def trial_times(events):
    """Seconds of the trial by event: the time since its start without the pauses before."""
    start = next(event["t_ns"] for event in events if event["kind"] == "trial_started")
    end = next(event["t_ns"] for event in events if event["kind"] == "trial_ended")
    begun = [event["t_ns"] for event in events if event["kind"] == "trial_paused"]
    over = [event["t_ns"] for event in events if event["kind"] == "trial_resumed"]
    pauses = list(zip(begun, over))
    return {
        event["seq"]: (time - start - sum(min(time, until) - since for since, until in pauses if since < time)) / 1e9
        for event in events
        for time in [min(event["t_ns"], end)]
        if event["t_ns"] >= start
    }


def compare(found, wanted, what):
    assert list(found) == list(wanted), (what, found)
    for key, value in wanted.items():
        if isinstance(value, set):
            assert found[key] in value, (what, key, found[key], value)
        elif isinstance(value, float):
            assert abs(float(found[key]) - value) <= 0.001, (what, key, found[key], value)
        else:
            assert found[key] == str(value), (what, key, found[key], value)


def main(tomcom, folder):
    recordings = simulate(tomcom, folder)
    recordings.append(pause(recordings[0]))
    python, rscript = sys.executable, shutil.which("Rscript")
    os.environ["PYTHONPATH"] = "packaging/python"
    has_r = rscript and subprocess.run([rscript, "-e", "library(jsonlite)"], capture_output=True).returncode == 0
    for recording in recordings:
        wanted = expected(recording)
        compare(figures(run(python, "examples/read_recording.py", recording)), wanted, recording)
        if has_r:
            compare(figures(run(rscript, "examples/read_recording.R", recording)), wanted, f"{recording} in R")
    continued = split(recordings[1])
    run(tomcom, "replay", continued, "--format", "json")
    compare(figures(run(python, "examples/read_recording.py", continued)), expected(recordings[1]), continued)
    tables = run(python, "examples/read_tables.py", folder / "study")
    assert "paired_difference: " in tables and "cause " in tables, tables
    for script in ["read_recording.py", "read_tables.py"]:
        assert f"{script} sessions/" in run(python, f"examples/{script}", code=1), script
    rates, presses = {}, 0
    with open(folder / "study/trials.csv", newline="", encoding="utf-8") as trials:
        for row in csv.DictReader(trials):
            if row["counts"] == "true":
                rates.setdefault(row["planned_arm"], []).append(float(row["error_rate_human"]))
                presses += int(row["human_presses"])
    assert sum(map(len, rates.values())) == 7 and f"presses_human: {presses}\n" in tables, (tables, presses)
    for condition, found in rates.items():
        assert f"error_rate_human {condition}: {statistics.fmean(found):.6f} in {len(found)} trials\n" in tables, (tables, rates)
    if has_r:
        again = run(rscript, "examples/read_tables.R", folder / "study")
        assert [line.rstrip() for line in again.splitlines()] == [line.rstrip() for line in tables.splitlines()], f"{again}\n{tables}"
        print(f"examples: {len(recordings)} recordings and the tables of a study, read alike by Python and R", flush=True)
    else:
        print(f"examples: {len(recordings)} recordings and the tables of a study, read by Python. NOT run: the R scripts, "
              "since Rscript with jsonlite is not installed (apt-get install r-base-core r-cran-jsonlite)", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
