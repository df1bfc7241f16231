"""Reads recordings as a lab would, with json, tomllib and pandas, and counts again what tomcom counts."""

import filecmp
import json
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pandas

from kitchen import Kitchen, Trial

RECORDINGS = Path("docs/recordings.md").read_text()
WRITING_A_KITCHEN = Path("docs/writing-a-kitchen.md").read_text()


def tomcom(*arguments, code=0, **options):
    """Runs a command that prints one JSON object."""
    done = subprocess.run([TOMCOM, *arguments, "--format", "json"], capture_output=True, text=True, **options)
    assert done.returncode == code, (arguments, done.returncode, done.stderr)
    return json.loads(done.stdout)


def read(recording):
    """The header of a recording, and its events as a table."""
    with open(Path(recording) / "events.jsonl", encoding="utf-8") as lines:
        header = json.loads(next(lines))
        events = pandas.DataFrame.from_records([json.loads(line) for line in lines])
    return header, events


def check_header(header, session):
    """A recording explains itself: format, settings, and the whole text of layout and recipes."""
    assert header["format"] == "tomcom-session" and header["version"] == 3, header["version"]
    assert "started" not in header, "a simulated recording knows no wall clock"
    asked_for = tomllib.loads(session.read_text())
    layout = session.parent / asked_for["layout"]
    recipes = layout.parent / tomllib.loads(layout.read_text())["recipes"]
    assert header["layout"]["text"] == layout.read_text()
    assert header["recipes"]["text"] == recipes.read_text()
    # Nobody signals in simulated trials, but the assistant in its arms of a plan, and a wizard that is simulated, too.
    is_scripted = asked_for.get("wizard", {}).get("kind") == "scripted"
    condition = header["session"]["trial"]["condition"]
    arms = {"none": "none", "wizard": "wizard", "wizard+advice": "wizard", "tom-com": "assistant", "tom": "assistant",
            "dev": "assistant"}
    planned = {arms[name] for name in asked_for.get("plan", {}).get("conditions", [])} | {"none"}
    assert condition in planned - (set() if is_scripted else {"wizard"}), condition
    assert header["session"]["trial"] == asked_for["trial"] | {"condition": condition}


def check_order(events):
    """Strictly ordered, no time before the one above it, every kind documented."""
    assert events["seq"].tolist() == list(range(len(events)))
    assert events["t_ns"].is_monotonic_increasing
    of_trial = events["kind"][events["kind"] != "protocol"]  # what a plan asks for before its trial
    assert of_trial.iloc[0] == "trial_started" and of_trial.iloc[-1] == "session_ended"
    for kind in events["kind"].unique():
        assert f"`{kind}`" in RECORDINGS, f"docs/recordings.md does not say what {kind} is"


def probes(events, did):
    """The events of this kind of freeze probes, which most sessions have not."""
    return events[(events["kind"] == "probe") & (events["did"] == did)] if "did" in events else events.iloc[:0]


def check_gaze(events):
    gaze = events[events["kind"] == "gaze"]
    # In a freeze probe simulated eyes stand still.
    frozen = probes(events, "ended")["t_ns"].sum() - probes(events, "begun")["t_ns"].sum()
    seconds = (gaze["t_ns"].iloc[-1] - gaze["t_ns"].iloc[0] - frozen) / 1e9
    rate_hz = (len(gaze) - 1) / seconds
    assert 115 < rate_hz < 125, f"simulated gaze at {rate_hz} Hz"
    assert gaze["confidence"].between(0, 1).all()
    on_display = (gaze["x"].between(0, 1) & gaze["y"].between(0, 1)).mean()
    assert on_display > 0.9, f"{on_display} of the gaze is on the display"


def check_beliefs(header, events):
    """Before each of its presses, and before each freeze probe, the participant tells what it believes of every aspect."""
    sizes = Kitchen(header["layout"]["text"], header["recipes"]["text"]).state_space()
    told = events[events["kind"] == "participant_believes"]
    pressed = ((events["kind"] == "press") & (events["agent"] == "human")).sum()
    assert len(told) == pressed + len(probes(events, "begun"))
    for aspects in told["aspects"]:
        assert [held["aspect"] for held in aspects] == list(sizes), aspects
        for held in aspects:
            values = held["values"]
            assert 0.01 <= min(values.values()) and sum(values.values()) <= 1 + 1e-4, held
            assert max(values, key=values.get) == held["believes"] or max(values.values()) == values[held["believes"]], held


def count(header, events):
    """Presses and served orders, by rules that were written a second time."""
    trial = Trial(Kitchen(header["layout"]["text"], header["recipes"]["text"]))
    presses = {"human": 0, "robot": 0}
    served = []
    rows = events[events["kind"].isin(["press", "order_shown", "order_cleared"])]
    for event in rows.itertuples():
        if event.kind == "order_shown":
            assert event.order not in trial.wanted, f"{event.order} is shown although another dish is wanted there"
            trial.wanted[event.order] = event.dish
        elif event.kind == "press":
            presses[event.agent] += 1
            _, order = trial.press(event.agent, event.button)
            served += [sum(presses.values())] if order else []
    per_order = [after - before for before, after in zip([0, *served], served)]
    return presses, per_order


def check_counts(recordings, figures):
    human = robot = 0
    per_order = []
    for recording in recordings:
        header, events = read(recording)
        presses, served = count(header, events)
        told = tomcom("replay", recording)
        assert told["events"] == len(events) and told["cut"] is False, told
        assert told["human_actions"] == presses["human"], (recording, told, presses)
        assert told["robot_actions"] == presses["robot"], (recording, told, presses)
        assert told["orders_served"] == len(served), (recording, told, served)
        human, robot = human + presses["human"], robot + presses["robot"]
        per_order += served
    assert (figures["human_actions"], figures["robot_actions"]) == (human, robot), figures
    assert figures["orders_served"] == len(per_order) > 0, figures
    assert figures["presses_per_order"] == pandas.Series(per_order).median(), figures
    return human + robot, len(per_order)


def check_alone(recording, scratch):
    """The log replays on its own: without its folder's other files, and with no kitchen near."""
    alone = scratch / "alone"
    shutil.rmtree(alone, ignore_errors=True)
    alone.mkdir(parents=True)
    shutil.copy(Path(recording) / "events.jsonl", alone)
    found = tomcom("replay", "events.jsonl", "--verify", cwd=alone)
    assert found["verified"] is True and found["cut"] is False, found
    # As after a power cut: the last line is not whole.
    log = alone / "events.jsonl"
    log.write_bytes(log.read_bytes()[:-7])
    found = tomcom("replay", "events.jsonl", "--verify", cwd=alone)
    assert found["verified"] is True and found["cut"] is True, found
    # As after somebody's hand: one press is another one.
    lines = log.read_text().splitlines(keepends=True)
    at = next(index for index, line in enumerate(lines) if '"kind":"press","agent":"robot"' in line)
    line = json.loads(lines[at])
    line["button"] = "trash"
    lines[at] = json.dumps(line, separators=(",", ":")) + "\n"
    log.write_text("".join(lines))
    found = tomcom("replay", "events.jsonl", "--verify", cwd=alone, code=1)
    assert found["verified"] is False and found["difference"]["line"] == at + 1, found


def check_session(session, scratch):
    once, again = scratch / session.stem, scratch / f"{session.stem}-again"
    figures = tomcom("simulate", session, "--trials", "3", "--seed", "11", "--out", once)
    recordings = figures["recordings"]
    assert figures["trials"] == len(recordings) == 3
    for recording in recordings:
        header, events = read(recording)
        check_header(header, session)
        check_order(events)
        check_gaze(events)
        check_beliefs(header, events)
    presses, orders = check_counts(recordings, figures)
    check_alone(recordings[0], scratch)
    tomcom("simulate", session, "--trials", "2", "--seed", "11", "--out", again)
    for recording in recordings[:2]:
        twin = again / Path(recording).name
        assert filecmp.cmp(Path(recording) / "events.jsonl", twin / "events.jsonl", shallow=False), twin
    print(f"{session}: 3 recordings read with pandas, {presses} presses and {orders} orders counted again, repeatable")


def check_kitchen(layout):
    """The size of the state space, computed a second time."""
    recipes = layout.parent / tomllib.loads(layout.read_text())["recipes"]
    sizes = Kitchen(layout.read_text(), recipes.read_text()).state_space()
    told = tomcom("kitchen", layout)
    assert {aspect["name"]: aspect["values"] for aspect in told["aspects"]} == sizes, (told["aspects"], sizes)
    states = 1
    for size in sizes.values():
        states *= size
    assert told["states"] == str(states), told["states"]
    print(f"{layout.name}: {states} states, computed again")


def check_documented_kitchen(scratch):
    """The kitchen that docs/writing-a-kitchen.md explains loads, and a session in it verifies."""
    files = re.findall(r"```toml\n# (\S+)\n(.*?)```", WRITING_A_KITCHEN, re.DOTALL)
    names = ["layouts/toast.toml", "recipes/toast.toml", "sessions/toast.toml"]
    assert sorted(name for name, _ in files) == names, files
    folder = scratch / "documented"
    for name, text in files:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    check_kitchen(folder / "layouts/toast.toml")
    figures = tomcom("simulate", folder / "sessions/toast.toml", "--out", folder / "recordings")
    check_counts(figures["recordings"], figures)
    found = tomcom("replay", figures["recordings"][0], "--verify")
    assert found["verified"] is True, found


if __name__ == "__main__":
    TOMCOM, scratch = sys.argv[1], Path(sys.argv[2])
    for layout in sorted(Path("layouts").glob("*.toml")):
        check_kitchen(layout)
    for session in sorted(Path("sessions").glob("*.toml")):
        check_session(session, scratch)
    check_documented_kitchen(scratch)
