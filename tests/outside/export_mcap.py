"""Exports recordings as MCAP, and reads them with the MCAP library for Python, a JSON Schema validator, Pinocchio and Rerun.

    export_mcap.py TOMCOM SCRATCH

Every event of the log is a message at its session time, every message is as the schema in the file says, frames are those of Pinocchio's kinematics
of the same joints, and `rerun mcap convert` reads the file.
"""

import json
import re
import sys
from collections import Counter
from pathlib import Path

import fastjsonschema
import numpy as np
import pinocchio
from mcap.reader import make_reader
from simulated import run, shortened

BIN = Path(sys.executable).parent
FOXGLOVE = {"/robot/joints": "foxglove.JointStates", "/tf": "foxglove.FrameTransforms", "/log": "foxglove.Log"}
SAMPLES = {"/gaze": "gaze", "/robot/joints": "robot_moves", "/tf": "robot_moves", "/robot/arm": "robot_moves"}


def simulate(tomcom, folder):
    session = shortened("sessions/default.toml", folder / "session.toml", 40)
    out = folder / "recordings"
    run(tomcom, "simulate", session, "--trials", 2, "--seed", 3, "--arm", "physics", "--condition", "assistant", "--out", out)
    return sorted(path for path in out.iterdir() if path.is_dir())


def read(file):
    """All messages with their topics, after a look at the file's checksums, schemas and description."""
    with open(file, "rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        [about] = reader.iter_metadata()
        messages = [(channel.topic, message, json.loads(message.data)) for _, channel, message in reader.iter_messages()]
    schemas = {channel.topic: summary.schemas[channel.schema_id] for channel in summary.channels.values()}
    assert summary.statistics.message_count == len(messages)
    assert all(channel.message_encoding == "json" for channel in summary.channels.values())
    assert {topic: schema.name for topic, schema in schemas.items() if topic in FOXGLOVE} == FOXGLOVE
    return messages, {topic: json.loads(schema.data) for topic, schema in schemas.items()}, about


def check(recording, messages, schemas):
    with open(recording / "events.jsonl", encoding="utf-8") as log:
        _, *events = map(json.loads, log)
    fits = {topic: fastjsonschema.compile(schema) for topic, schema in schemas.items()}
    kinds, topics = Counter(event["kind"] for event in events), Counter(topic for topic, *_ in messages)
    for topic, kind in SAMPLES.items():
        assert topics[topic] == kinds[kind] > 0, (topic, topics[topic], kinds[kind])
    assert topics["/events"] == len(events) - kinds["gaze"] - kinds["robot_moves"]
    assert topics["/beliefs"] == kinds["participant_believes"] + kinds["belief_estimated"] > 0
    moves = iter([event for event in events if event["kind"] == "robot_moves"])
    times = [message.log_time for _, message, _ in messages]
    assert times == sorted(times)
    for topic, message, content in messages:
        fits[topic](content)
        if topic in ("/events", "/gaze", "/beliefs"):
            event = events[content["seq"]]
            assert message.log_time == event["t_ns"]
        if topic == "/events":
            assert {"seq": event["seq"], "t_ns": event["t_ns"], "kind": event["kind"], **content["event"]} == event
        if topic == "/gaze":
            assert all(content[key] == event[key] for key in ("x", "y", "confidence"))
            assert message.publish_time == event.get("taken_ns", event["t_ns"])
        if topic == "/robot/joints":
            move = next(moves)
            assert [joint["position"] for joint in content["joints"]] == move["joints"] and message.log_time == move["t_ns"]
    return topics


def check_frames(messages):
    """The frames of the links by the kinematics of another library."""
    model = pinocchio.buildModelFromUrdf("src/arm/ur5.urdf")
    data = model.createData()
    base, away_m, away_rad, count = model.getFrameId("base_link"), 0.0, 0.0, 0
    joints = {}
    for topic, message, content in messages:
        if topic == "/robot/joints":
            joints[message.log_time] = {joint["name"]: joint["position"] for joint in content["joints"]}
        if topic != "/tf":
            continue
        angles = joints[message.log_time]
        pinocchio.framesForwardKinematics(model, data, np.array([angles[name] for name in model.names[1:]]))
        for frame in content["transforms"]:
            assert frame["parent_frame_id"] == "base_link"
            if frame["child_frame_id"] == "hand":
                continue
            place = data.oMf[base].inverse() * data.oMf[model.getFrameId(frame["child_frame_id"], pinocchio.FrameType.BODY)]
            at, turn = frame["translation"], frame["rotation"]
            turn = pinocchio.Quaternion(turn["w"], turn["x"], turn["y"], turn["z"]).toRotationMatrix()
            away_m = max(away_m, np.linalg.norm(place.translation - np.array([at["x"], at["y"], at["z"]])))
            away_rad = max(away_rad, np.linalg.norm(pinocchio.log3(place.rotation.T @ turn)))
            count += 1
    assert count > 0 and away_m < 1e-6 and away_rad < 1e-6, (count, away_m, away_rad)
    return count, away_m, away_rad


def convert(file, out, topics):
    """Rerun finds nothing wrong with the file, and has every message of every channel after the conversion."""
    run(BIN / "rerun", "mcap", "check", "--full", file)
    run(BIN / "rerun", "mcap", "convert", file, "-o", out)
    told = run(BIN / "rerun", "rrd", "print", out)
    rows = Counter()
    for count, topic in re.findall(r"with (\d+) rows \([^)]*\) - (/\S+) - data columns: \[McapMessage:data\]", told):
        rows[topic] += int(count)
    assert rows == topics, (rows, topics)
    return sum(rows.values())



def main(tomcom, folder):
    recordings = simulate(tomcom, folder)
    told = json.loads(run(tomcom, "export", folder / "recordings", "--mcap", "--format", "json"))["mcap"]
    assert [Path(one["file"]) for one in told] == [recording / "recording.mcap" for recording in recordings]
    for recording, one in zip(recordings, told):
        messages, schemas, about = read(one["file"])
        topics = check(recording, messages, schemas)
        assert {topic: count for topic, count in one["messages"].items() if count} == dict(topics)
        assert about.name == "tomcom" and about.metadata["recording"] == recording.name
        assert (about.metadata["condition"], about.metadata["arm"]) == ("assistant", "tom-com"), about.metadata
        lines = run(tomcom, "replay", recording).splitlines()
        words = [content["message"] for topic, _, content in messages if topic == "/log"]
        missing = [line for line in words if not any(line in printed for printed in lines)]
        assert not missing, missing[:3]
        frames, away_m, away_rad = check_frames(messages)
        converted = convert(one["file"], folder / f"{recording.name}.rrd", topics)
        print(f"{recording.name}: {dict(topics)}; {frames} frames at most {away_m:.1e} m and {away_rad:.1e} rad from Pinocchio's; Rerun reads {converted} messages", flush=True)
    # Beside its log it belongs to the recording.
    code = about.metadata["participant"]
    run(tomcom, "forget", code, "--in", folder / "recordings", "--yes")
    assert not recordings[-1].exists(), "an MCAP goes with its recording"


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
