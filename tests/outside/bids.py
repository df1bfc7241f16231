"""Exports recordings as a BIDS data set, and looks at it with the BIDS validator and pandas.

    bids.py TOMCOM SCRATCH

The validator finds no error, and no warning but those that are listed here with their reasons. The tables hold as many rows as the logs have
events, and the same values. Nothing that somebody typed is in the tree unless it is asked for, and no two codes become one participant.
"""

import filecmp
import json
import subprocess
import sys
from pathlib import Path

import pandas as pd
from simulated import run, shortened

SESSION = Path("sessions/paper.toml")
TYPED = "Erika Mustermann came in"
VALIDATOR = Path(sys.executable).with_name("bids-validator-deno")
# What the validator warns of, and why it stays: recommended fields that nobody but the lab knows, or that do not exist here.
WARNINGS = {
    "Authors": "the program knows no authors",
    "TOO_FEW_AUTHORS": "the same",
    "License": "the lab's to choose",
    "SourceDatasets": "recordings have no address",
    "HEDVersion": "there are no tags of this kind",
    "CogAtlasID": "there is no entry for the task",
    "CogPOID": "the same",
    "InstitutionName": "the lab's to fill in",
    "InstitutionAddress": "the same",
    "InstitutionalDepartmentName": "the same",
    "Instructions": "told by the wizard, or shown in the tutorial",
}


def lines(recording):
    with open(recording / "events.jsonl", encoding="utf-8") as log:
        return [json.loads(line) for line in log]


def write(recording, log):
    """The events are numbered anew from 0; none may come before the one above it."""
    header, *events = log
    for number, event in enumerate(events):
        event["seq"] = number
    text = "".join(json.dumps(line, separators=(",", ":"), ensure_ascii=False) + "\n" for line in (header, *events))
    (recording / "events.jsonl").write_text(text, encoding="utf-8")


def simulate(tomcom, folder):
    """A short study, and two trials with the arm in the physics, outside of any plan."""
    session = shortened(SESSION, folder / "study.toml", 40)
    recordings = folder / "recordings"
    run(tomcom, "simulate", session, "--trials", 4, "--seed", 5, "--out", recordings)
    alone = shortened("sessions/default.toml", folder / "alone.toml", 20)
    run(tomcom, "simulate", alone, "--trials", 3, "--seed", 7, "--arm", "physics", "--out", recordings)
    return recordings


def rename(recording, code):
    header, *events = lines(recording)
    header["session"]["participant"]["code"] = code
    write(recording, [header, *events])


def add_person(recording, answers):
    """Adds what simulated participants do not have: a display, what a tracker finds, a note, a questionnaire."""
    header, *events = lines(recording)
    last = events.pop()
    assert last["kind"] == "session_ended"
    asked = {
        "name": "demographics",
        "title": "About you",
        "language": "en",
        "scale": {"points": 7, "low": "not at all", "high": "very"},
        "item": [
            {"id": "age", "text": "Your age", "kind": "number", "min": 18, "max": 99, "unit": "years"},
            {"id": "hand", "text": "You write with", "kind": "choice", "options": [{"id": "left", "text": "the left hand"}, {"id": "right", "text": "the right hand"}]},
            {"id": "tired", "text": "How tired are you?", "reversed": True},
            {"id": "job", "text": "What do you do?", "kind": "text"},
        ],
    }
    phases = header["session"]["step"]["phase"]
    phases.append({"what": "questionnaire", "questionnaire": asked})
    now = last["t_ns"]
    more = [
        {"kind": "marker", "note": TYPED},
        {"kind": "display", "what": "connected", "width_px": 1920, "height_px": 1080},
        {"kind": "tracker", "what": "fixation", "at": [0.25, 0.75], "duration_ms": 321.5, "dispersion_deg": 0.5, "confidence": 0.9, "device_ns": 7, "began_ns": now - 10**9},
        {"kind": "tracker", "what": "blink", "closed": True, "confidence": 0.8, "device_ns": 8, "taken_ns": now - 5 * 10**8},
        {"kind": "tracker", "what": "blink", "closed": False, "confidence": 0.8, "device_ns": 9, "taken_ns": now - 4 * 10**8},
        {"kind": "protocol", "what": "phase_started", "phase": "questionnaire", "number": len(phases)},
        *({"kind": "protocol", "what": "item_answered", "item": item, "answer": answer} for item, answer in answers.items()),
        {"kind": "protocol", "what": "answers_confirmed"},
    ]
    for number, event in enumerate(more):
        events.append({"seq": 0, "t_ns": now + number * 10**7, **event})
    events.append({**last, "t_ns": now + 10**9})
    write(recording, [header, *events])


def split(recording):
    """The same recording in two parts: the first one cut, the second one continues it."""
    text = (recording / "events.jsonl").read_text().splitlines()
    at = len(text) // 2
    folders = [recording.parent.parent / "parted" / name for name in ("cut", "cut-part2")]
    for folder in folders:
        folder.mkdir(parents=True)
    begins = json.loads(text[at - 1])
    first = json.loads(text[0]) | {"started": "2026-03-14T09:00:00Z"}
    header = first | {"continues": {"recording": "cut", "events": begins["seq"] + 1, "t_ns": begins["t_ns"]}, "started": "2026-03-14T09:30:00Z"}
    (folders[0] / "events.jsonl").write_text("\n".join([json.dumps(first), *text[1:at]]) + "\n")
    (folders[1] / "events.jsonl").write_text("\n".join([json.dumps(header), *text[at:]]) + "\n")
    return folders


def validate(tree):
    """Errors and warnings by what they are about: a field, or else their code."""
    done = subprocess.run([VALIDATOR, tree, "--format", "json", "--max-rows", "-1"], capture_output=True, text=True)
    issues = json.loads(done.stdout)["issues"]["issues"]
    found = {"error": {}, "warning": {}}
    for issue in issues:
        if issue["severity"] in found:
            about = found[issue["severity"]].setdefault(issue.get("subCode") or issue["code"], [])
            about.append((issue["code"], issue.get("location"), issue.get("issueMessage")))
    return found


def table(path):
    if path.name.endswith(".gz"):
        names = json.loads(path.with_name(path.name.removesuffix(".tsv.gz") + ".json").read_text())["Columns"]
        return pd.read_csv(path, sep="\t", names=names, na_values="n/a", dtype={"device_time": str})
    return pd.read_csv(path, sep="\t", na_values="n/a", keep_default_na=False)


def check_recording(tree, place, recording):
    """The tables of a recording against its log."""
    _, *log = lines(recording)
    files = {path.name.removeprefix(Path(place).name + "_"): table(path) for path in (tree / place).parent.glob("*.tsv*")}
    events = files["events.tsv"]
    numbers = [number for name, rows in files.items() if name != "beh.tsv" for number in rows["seq"]]
    assert sorted(numbers) == list(range(len(log))), f"{place}: {len(numbers)} rows, {len(log)} events"
    for name, rows in files.items():
        described = json.loads((tree / place).parent.joinpath(f"{Path(place).name}_{name.split('.')[0]}.json").read_text())
        assert set(rows.columns) <= set(described), f"{name}: {set(rows.columns) - set(described)} are not described"
        if name == "beh.tsv":
            told = sum(len(event["aspects"]) for event in log if event["kind"] in ("participant_believes", "belief_estimated"))
            assert len(rows) == told
            continue
        for number, time in zip(rows["seq"], rows["arrival" if "arrival" in rows else rows.columns[0]]):
            if "physioevents" not in name:
                assert abs(time - log[number]["t_ns"] / 1e9) < 1e-6, (name, number, time)
    for row in events.itertuples():
        event = log[row.seq]
        assert row.trial_type == event["kind"]
        for key in ("button", "dish", "content"):
            if isinstance(event.get(key), str):
                assert getattr(row, key) == event[key], (key, event, row)
        if event["kind"] == "press":
            assert row.agent == event["agent"] and row.effective in (0, 1)
    gaze = files.get("recording-eye1_physio.tsv.gz")
    if gaze is not None:
        assert gaze["timestamp"].is_monotonic_increasing
        for row in gaze.itertuples():
            assert (row.x_coordinate, row.y_coordinate, row.confidence) == tuple(log[row.seq][key] for key in ("x", "y", "confidence"))
    arm = files.get("recording-arm_stim.tsv.gz")
    if arm is not None:
        for row in arm.itertuples():
            assert [getattr(row, f"joint_{joint}") for joint in range(1, 7)] == log[row.seq]["joints"]
    check_durations(events, log)
    return {name: len(rows) for name, rows in files.items()}


def check_durations(events, log):
    """A signal lasts until it disappears, another replaces it, or the trial is over; a press is a moment."""
    shown = events[events["trial_type"] == "signal_shown"]
    for row in shown.itertuples():
        over = next(e["t_ns"] for e in log[row.seq + 1:] if e["kind"] in ("signal_ended", "signal_shown", "trial_ended", "session_ended"))
        assert abs(row.duration - (over - log[row.seq]["t_ns"]) / 1e9) < 1e-6, row
    assert (events.loc[events["trial_type"] == "press", "duration"] == 0).all()
    [trial] = events.loc[events["trial_type"] == "trial_started", "duration"]
    [began], [ended] = ([e["t_ns"] for e in log if e["kind"] == kind] for kind in ("trial_started", "trial_ended"))
    assert abs(trial - (ended - began) / 1e9) < 1e-6


def check_errors(tomcom, tree, told, folder):
    """Presses that count as errors are those of the study's tables."""
    run(tomcom, "study", folder / "recordings", "--out", folder / "tables", "--skip", "concepts", "--format", "json")
    actions = pd.read_csv(folder / "tables" / "actions.csv", keep_default_na=False)
    compared = 0
    for one in told["recordings"]:
        events = table(tree / (one["place"] + "_events.tsv"))
        own = actions[(actions["recording"] == Path(one["recording"]).name) & (actions["agent"] == "human")]
        mine = events[(events["trial_type"] == "press") & (events["agent"] == "human")]
        if len(own):
            assert mine["error"].astype(int).tolist() == own["error"].astype(str).str.lower().isin(("1", "true")).astype(int).tolist()
            compared += len(own)
    assert compared > 0
    return compared


def same(one, other):
    """Whether two folders have the same files with the same bytes."""
    compared = filecmp.dircmp(one, other)
    assert not compared.left_only and not compared.right_only and not compared.funny_files
    assert not filecmp.cmpfiles(one, other, compared.common_files, shallow=False)[1]
    for name in compared.common_dirs:
        same(one / name, other / name)


def typed_in(tree):
    return [path for path in tree.rglob("*") if path.is_file() and TYPED in path.read_bytes().decode("utf-8", "replace")]


def main(tomcom, folder):
    recordings = simulate(tomcom, folder)
    planned = sorted(path for path in recordings.iterdir() if path.is_dir() and lines(path)[0]["session"].get("step"))
    alone = sorted(set(path for path in recordings.iterdir() if path.is_dir()) - set(planned))
    assert len(planned) == 4 and len(alone) == 3
    for recording, code in zip(alone, ("Q-07", "Q07", "Q_07")):
        rename(recording, code)
    answers = {"age": 31, "hand": "left", "tired": 5, "job": TYPED}
    add_person(planned[0], answers)
    run(tomcom, "exclude", planned[2], "--reason", TYPED)

    # Recordings of no plan have a tree of their own: beside those of a plan they are left out, and named.
    tree, tree_alone = folder / "bids", folder / "bids-alone"
    told = json.loads(run(tomcom, "export", recordings, "--bids", tree, "--format", "json"))["bids"]
    assert sorted(one["recording"] for one in told["foreign"]) == [path.name for path in alone], told["foreign"]
    told_alone = json.loads(run(tomcom, "export", *alone, "--bids", tree_alone, "--format", "json"))["bids"]
    assert (len(told["recordings"]), len(told_alone["recordings"])) == (4, 3)
    warned = set()
    for found in (validate(tree), validate(tree_alone)):
        assert not found["error"], json.dumps(found["error"], indent=1)[:4000]
        assert set(found["warning"]) <= set(WARNINGS), {code: found["warning"][code][:4] for code in set(found["warning"]) - set(WARNINGS)}
        warned |= set(found["warning"])
    print(f"validator: no error; warned of {', '.join(sorted(warned))}", flush=True)

    rows, events = {}, 0
    for where, one in [(tree, one) for one in told["recordings"]] + [(tree_alone, one) for one in told_alone["recordings"]]:
        for name, count in check_recording(where, one["place"], Path(one["recording"])).items():
            rows[name] = rows.get(name, 0) + count
        events += len(lines(Path(one["recording"]))) - 1
    assert events == sum(count for name, count in rows.items() if name != "beh.tsv")
    assert {"recording-eye1_physio.tsv.gz", "recording-eye1_physioevents.tsv.gz", "recording-arm_stim.tsv.gz"} <= set(rows)
    print(f"rows: {events} events of 7 logs in {rows}; {check_errors(tomcom, tree, told, folder)} presses judged alike", flush=True)

    people = table(tree / "participants.tsv")
    others = table(tree_alone / "participants.tsv")
    labels = dict(zip(others["code"], others["participant_id"]))
    why = [one for file in tree.glob("sub-*/*_sessions.tsv") for one in table(file)["left_out"].dropna()]
    assert why == ["excluded"] and people["left_out"].sum() == 1, (why, people)
    assert len(people) == 2 and len(others) == 3 and len({label.lower() for label in labels.values()}) == 3, labels
    assert labels["Q07"] == "sub-Q07" and sorted(labels[code] for code in ("Q-07", "Q_07")) == ["sub-Q07x2", "sub-Q07x3"], labels
    assert {code for code, _ in told_alone["changed_codes"]} == {"Q-07", "Q_07"}
    [filled] = table(tree / "phenotype/demographics.tsv").to_dict("records")
    assert {key: filled[key] for key in ("age", "hand", "tired")} == {"age": 31, "hand": "left", "tired": 5}
    assert "job" not in filled and filled["participant_id"] in people["participant_id"].tolist()
    assert not typed_in(tree), typed_in(tree)

    same(tree, folder / "again") if run(tomcom, "export", recordings, "--bids", folder / "again") else None
    assert "not empty" in run(tomcom, "export", recordings, "--bids", tree, code=2)
    run(tomcom, "export", planned[0], "--bids", folder / "typed", "--words")
    assert len(typed_in(folder / "typed")) == 2, "in the events and the questionnaire"
    assert not validate(folder / "typed")["error"]
    print("labels: three codes alike are three participants; what was typed is left out unless --words asks for it", flush=True)

    first, second = split(planned[1])
    told_parts = json.loads(run(tomcom, "export", first, second, second, "--bids", folder / "parts", "--format", "json"))["bids"]
    [one] = told_parts["recordings"]
    assert one["rows"]["events"] + one["rows"]["gaze"] == len(lines(planned[1])) - 1, "a part is read with those before it, and once"
    [begun] = table(next((folder / "parts").glob("sub-*/sub-*_sessions.tsv"))).to_dict("records")
    assert begun["acq_time"] == "2026-03-14T09:00:00Z", "onsets count from the beginning of the first part"

    # Whether the validator would have seen it.
    table_of = tree / (told["recordings"][0]["place"] + "_events.tsv")
    table_of.write_text(table_of.read_text().replace("onset\t", "begin\t", 1))
    assert validate(tree)["error"], "the validator finds nothing in a table without onsets"


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
