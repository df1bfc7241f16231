"""Annotations for other programs, read back by these programs' own readers: ELAN files by pympi-ling, projects of BORIS by BORIS,
subtitles by ffmpeg; and codes that raters give there, taken back.

    tests/outside/annotations.py TOMCOM FOLDER [PYTHON WITH BORIS]
"""

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pympi

AHEAD_S = 4.25
BELIEF = "belief: cooking_pot"


def tomcom(*arguments, code=0):
    done = subprocess.run([TOMCOM, *map(str, arguments), "--format", "json"], capture_output=True, text=True)
    assert done.returncode == code, (arguments, done.returncode, done.stderr)
    return json.loads(done.stdout) if code == 0 else " ".join(done.stderr.split())


def recorded(folder):
    """A recording with errors, two films, and the codes of a rater; its events."""
    out = folder / "recordings"
    tomcom("simulate", "sessions/default.toml", "--trials", "1", "--seed", "7", "--arm", "timed", "--out", out)
    (recording,) = out.iterdir()
    for name, size in (("room", "320x180"), ("hands", "160x90")):
        subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-f", "lavfi", "-i", f"testsrc=size={size}:rate=25:duration=20", folder / f"{name} 1.mp4"],
                       check=True)
    tomcom("video", "attach", recording, folder / "room 1.mp4", "--offset", AHEAD_S + 2)
    tomcom("video", "attach", recording, folder / "hands 1.mp4", "--offset", AHEAD_S)
    events = [json.loads(line) for line in (recording / "events.jsonl").read_text().splitlines()[1:]]
    return recording, events


def errors_of(recording):
    """Errors by their number, as `tomcom codes` numbers them: told by the export."""
    elan = pympi.Elan.Eaf(recording / "recording.eaf", suppress_version_warning=True)
    return elan.get_annotation_data_for_tier("errors")


def check_elan(recording, events):
    elan = pympi.Elan.Eaf(recording / "recording.eaf", suppress_version_warning=True)
    for agent in ("human", "robot"):
        pressed = [event for event in events if event["kind"] == "press" and event["agent"] == agent]
        told = elan.get_annotation_data_for_tier(f"presses {agent}")
        assert [words for *_, words in told] == [event["button"].replace("_", " ") for event in pressed], agent
        for (begin, end, _), event in zip(told, pressed):
            assert end > begin and abs(begin / 1000 - event["t_ns"] / 1e9 - AHEAD_S) < 0.0011, (begin, event)
    shown = [event for event in events if event["kind"] == "signal_shown"]
    assert len(elan.get_annotation_data_for_tier("signals")) == len(shown)
    for tier in elan.get_tier_names():
        told = elan.get_annotation_data_for_tier(tier)
        assert all(one[1] <= other[0] for one, other in zip(told, told[1:])), f"annotations of {tier} overlap"
    films = elan.get_linked_files()
    assert [Path(film["MEDIA_URL"]).name for film in films] == ["hands%201.mp4", "room%201.mp4"], films
    assert films[0].get("TIME_ORIGIN") is None and films[1]["TIME_ORIGIN"] == "2000", films
    assert BELIEF in str(elan.controlled_vocabularies["causes"]), elan.controlled_vocabularies
    return elan


# Run by a Python that has BORIS: opens a project as BORIS does, and tells what BORIS finds wrong with it.
BORIS = """
import json, sys
from boris import config, project_functions
_, changed, project, message = project_functions.open_project_json(sys.argv[1])
assert "error" not in project and not message, (project, message)
said = project_functions.check_project_integrity(project, config.HHMMSS, sys.argv[1], media_file_available=True)
print(json.dumps({"said": said, "observations": project["observations"]}, default=float))
"""


def check_boris(recording, errors):
    if not BORIS_PYTHON:
        print("BORIS cannot be had here: its projects are not read by its own reader", flush=True)
        return
    path = recording / "recording.boris"
    done = subprocess.run([BORIS_PYTHON, "-c", BORIS, path], capture_output=True, text=True, env={**os.environ, "QT_QPA_PLATFORM": "offscreen"})
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout.splitlines()[-1])
    (observation,) = found["observations"].values()
    assert observation["type"] == "MEDIA" and observation["media_info"]["offset"] == {"1": 0.0, "2": 2.0}, observation["media_info"]
    # The length of a film that was attached by hand is not known.
    assert all("Length not available" in line for line in found["said"].split("<br><br>") if line), found["said"]
    told = [event for event in observation["events"] if event[2] == "errors"]
    assert [round(event[0], 3) for event in told] == [begin / 1000 for begin, *_ in errors]
    print(f"BORIS's own reader: {len(observation['events'])} events, no fault but the films' lengths", flush=True)


def check_vtt(recording, number):
    done = subprocess.run(["ffmpeg", "-loglevel", "error", "-i", recording / "recording.vtt", "-f", "srt", "-"], capture_output=True, text=True, check=True)
    assert done.stdout.count(" --> ") == number and not done.stderr, (done.stdout.count(" --> "), number, done.stderr)
    assert "errors: error 1: " in done.stdout and "presses human: " in done.stdout


def check_ends(recording, errors):
    """An error begins and ends at the same times in ELAN's file, in the subtitles and in `tomcom review --errors`, to the millisecond."""
    seconds = lambda text: sum(60**place * float(part) for place, part in enumerate(reversed(text.split(":"))))
    cues = re.findall(r"(\S+) --> (\S+)\nerrors: error (\d+): ", (recording / "recording.vtt").read_text())
    assert [round(1000 * seconds(begin)) for begin, *_ in cues] == [begin for begin, *_ in errors]
    assert [round(1000 * seconds(end)) for _, end, _ in cues] == [end for _, end, _ in errors]
    done = subprocess.run([TOMCOM, "review", recording, "--errors"], capture_output=True, text=True, check=True)
    told = re.findall(r"--at (\S+)  # to (\S+|the end), error ", done.stdout)
    assert len(told) == len(errors), done.stdout
    for (begin, end), (first, last, _) in zip(told, errors):
        assert end == "the end" or abs(1000 * (seconds(end) - seconds(begin)) - (last - first)) < 1.5, (begin, end, first, last)


def coded(recording, rater):
    out = recording.parent.parent / "codes.csv"
    out.unlink(missing_ok=True)
    tomcom("codes", recording, "--export", out)
    return [row for row in csv.DictReader(out.open()) if row["rater"] == rater]


def main():
    folder = Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    recording, events = recorded(folder)
    told = tomcom("export", recording, "--elan", "--boris", "--vtt")["annotations"]
    assert [Path(one["file"]).name for one in told] == ["recording.eaf", "recording.boris", "recording.vtt"], told
    elan, errors = check_elan(recording, events), errors_of(recording)
    assert len(errors) >= 2 and errors[0][2].startswith("error 1: "), errors
    check_boris(recording, errors)
    check_vtt(recording, told[2]["annotations"])
    check_ends(recording, errors)
    print(f"ELAN by pympi-ling: {told[0]['annotations']} annotations on {len(list(elan.get_tier_names()))} tiers, films linked", flush=True)

    # A rater codes in ELAN, another in BORIS; exports that were changed there are kept.
    causes = [("slip", "race", BELIEF, "other", "buttons")[index % 5] for index in range(len(errors))]
    elan.add_tier("codes R1", ling="coded")
    for (begin, end, _), cause in zip(errors, causes):
        elan.add_annotation("codes R1", begin, end, cause)
    elan.to_file(recording / "recording.eaf")
    tomcom("codes", recording, "--import", recording / "recording.eaf", "--yes")
    taken = coded(recording, "R1")
    assert [row["cause"] + (f": {row['aspect']}" if row["aspect"] else "") for row in taken] == causes, taken
    refused = tomcom("export", recording, "--elan", code=2)
    assert "recording.eaf" in refused and "import its codes" in refused, refused
    project = json.loads((recording / "recording.boris").read_text())
    (observation,) = project["observations"].values()
    for (begin, *_), cause in zip(errors, causes):
        observation["events"].append([begin / 1000 + 0.4, "R2", "code", cause, "", "NA"])
    (recording / "recording.boris").write_text(json.dumps(project))
    tomcom("codes", recording, "--import", recording / "recording.boris", "--yes")
    assert [row["press"] for row in coded(recording, "R2")] == [row["press"] for row in taken]
    assert [row["cause"] for row in coded(recording, "R2")] == [row["cause"] for row in taken]
    # Both come back in the next export, and again in the same words.
    for name in ("recording.eaf", "recording.boris"):
        (recording / name).unlink()
    tomcom("export", recording, "--elan", "--boris", "--vtt")
    again = pympi.Elan.Eaf(recording / "recording.eaf", suppress_version_warning=True)
    for rater in ("R1", "R2"):
        assert [words for *_, words in again.get_annotation_data_for_tier(f"codes {rater}")] == causes
    tomcom("codes", recording, "--import", recording / "recording.eaf", "--yes")
    tomcom("codes", recording, "--import", recording / "recording.boris", "--yes")
    assert coded(recording, "R1") == taken
    # A code beside no error is refused, with its place.
    far = max(begin for begin, *_ in errors) + 60_000
    again.add_annotation("codes R1", far, far + 500, "slip")
    again.to_file(recording / "recording.eaf")
    refused = tomcom("codes", recording, "--import", recording / "recording.eaf", "--yes", code=2)
    assert f"the code \"slip\" of R1 at {far / 1000:.2f} s" in refused and "the nearest is error" in refused, refused
    # Raters who are to code blind get presses and errors alone.
    (recording / "recording.eaf").unlink()
    tomcom("export", recording, "--elan", "--blind")
    blind = pympi.Elan.Eaf(recording / "recording.eaf", suppress_version_warning=True)
    assert list(blind.get_tier_names()) == ["presses human", "presses robot", "errors"]
    print(f"codes of {len(errors)} errors taken back from ELAN and from BORIS, and exported again", flush=True)


if __name__ == "__main__":
    TOMCOM, BORIS_PYTHON = sys.argv[1], next((path for path in sys.argv[3:] if Path(path).exists()), None)
    main()
