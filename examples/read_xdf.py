"""Reads the streams of a session from a file of LabRecorder (XDF), and prints a few figures.

    read_xdf.py FILE.xdf

Needs pyxdf and pandas. All streams have one clock here, that of the recording computer, so that those of other devices (EEG, heart rate)
can be cut out around the events.
"""

import json
import sys

try:
    import numpy
    import pandas
    import pyxdf
except ModuleNotFoundError as missing:
    sys.exit(f"{missing.name} is not installed: pip install pyxdf pandas")


def read(file):
    """The streams of this program by name of the outlet, each a table with a row for each sample and its time in seconds."""
    # Stamps are those of the events: they must not be made regular.
    streams, _ = pyxdf.load_xdf(file, dejitter_timestamps=False)
    tables = {}
    for stream in streams:
        source = (stream["info"]["source_id"][0] or "").split("-")
        if source[0] != "tomcom":
            continue
        labels = [channel["label"][0] for channel in stream["info"]["desc"][0]["channels"][0]["channel"]]
        table = pandas.DataFrame(numpy.asarray(stream["time_series"]).reshape(-1, len(labels)), columns=labels)
        table.insert(0, "time", stream["time_stamps"])
        tables[source[-1]] = table
    return tables


if len(sys.argv) != 2:
    sys.exit(__doc__)
tables = read(sys.argv[1])
for name, table in sorted(tables.items()):
    print(f"{name}: {len(table)} samples")
if "events" in tables:
    events = pandas.DataFrame.from_records([json.loads(event) for event in tables["events"]["event"]])
    events["time"] = tables["events"]["time"]
    # Each recording and its trial begin with a sample that names it, which is no event.
    for recording in events.loc[events["kind"] == "recording", "recording"].unique() if "recording" in events else []:
        print(f"recording: {recording}")
if "presses" in tables:
    presses = tables["presses"]
    human = presses[presses["agent"] == "human"]
    print(f"presses_human: {len(human)}")
    print(f"errors_human: {(human['error'] == 'yes').sum()}")
if {"presses", "gaze"} <= tables.keys():
    # What is cut out around an event: here the gaze in the half second before each press of the participant.
    gaze = tables["gaze"]
    before = [gaze[(gaze["time"] > at - 0.5) & (gaze["time"] <= at)] for at in human["time"]]
    print(f"gaze_before_press: {numpy.median([len(window) for window in before]):.0f} samples")
