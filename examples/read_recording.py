"""Reads a recording with pandas, without tomcom.

    python examples/read_recording.py sessions/2026-03-14-P07-1

Prints who took part, how the trial went, and where gaze was. `read` and `trial_clock` are meant to be copied.
"""

import json
import sys
from pathlib import Path

import pandas


def read(recording):
    """The header of a recording, and its events as a table with one row each, over all of its parts."""
    recording = Path(recording)
    with open(recording / "events.jsonl", encoding="utf-8") as lines:
        header = json.loads(next(lines))
        # A recording that was cut can end in the middle of a line.
        events = [json.loads(line) for line in lines if line.endswith("\n")]
    table = pandas.DataFrame.from_records(events)
    if "continues" in header:
        before = header["continues"]
        _, earlier = read(recording.parent / before["recording"])
        table = pandas.concat([earlier[earlier["seq"] < before["events"]], table], ignore_index=True)
    table["seconds"] = table["t_ns"] / 1e9  # session time
    return header, table


def trial_clock(events):
    """The trial's clock at every event, in seconds: it stands still in pauses. Nothing before the trial, its length after it."""
    running, since, before, clock = False, 0, 0, []
    started = False
    for kind, now in zip(events["kind"], events["t_ns"]):
        if kind in ("trial_started", "trial_resumed"):
            running, since, started = True, now, True
        clock.append((before + (now - since if running else 0)) / 1e9 if started else float("nan"))
        if running and kind in ("trial_paused", "trial_ended", "trial_aborted"):
            running, before = False, before + now - since
    return pandas.Series(clock, index=events.index)


def main(recording):
    header, events = read(recording)
    session = header["session"]
    events["trial_s"] = trial_clock(events)
    kinds = events["kind"].value_counts()
    presses = events[events["kind"] == "press"]
    human = presses[presses["agent"] == "human"]
    print("participant:", session["participant"]["code"])
    print("condition:", session["trial"]["condition"])
    print("events:", len(events))
    print("trial_s:", round(events["trial_s"].max(), 3))
    print("presses_human:", len(human))
    print("presses_robot:", len(presses) - len(human))
    print("signals:", int(kinds.get("signal_shown", 0)))
    print("orders:", int(kinds.get("order_shown", 0)))
    if len(human) > 1:
        print("median_s_between_presses:", round(human["trial_s"].diff().median(), 3))
        print("most_pressed:", human["button"].value_counts().sort_index().idxmax())
    if "gaze" in kinds:
        gaze = events[events["kind"] == "gaze"]
        seen = gaze[gaze["confidence"] >= 0.6]
        print("gaze_samples:", len(gaze))
        print("gaze_on_display:", round((seen["x"].between(0, 1) & seen["y"].between(0, 1)).mean(), 3))


if __name__ == "__main__":
    main(sys.argv[1])
