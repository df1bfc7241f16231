"""Simulated recordings, as the checks of analyses and exports make and change them."""

import json
import re
import subprocess
from pathlib import Path


def run(*arguments, code=0):
    """What a command printed; with a `code` that is not 0 also its messages."""
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True)
    assert done.returncode == code, f"{arguments}\n{done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + (done.stderr if code else "")


def shortened(original, path, presses, more=""):
    """A session file of this repository as `path`, with trials of so many presses, and with `more` at its end."""
    text = Path(original).read_text().replace('"../', f'"{Path.cwd()}/')
    text = re.sub(r"(?m)^presses = \d+", f"presses = {presses}", text)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text + more)
    return path


def recordings_in(folder):
    return sorted(path for path in folder.iterdir() if (path / "events.jsonl").exists())


def as_people(recordings, out):
    """The recordings as if people had made them: what participants believed is not known. Returns the new folders."""
    folders = []
    for recording in recordings:
        head, *lines = (recording / "events.jsonl").read_text().splitlines(keepends=True)
        header = json.loads(head)
        participant = header["session"]["participant"]
        participant["kind"], participant["gaze"] = "keyboard", "json"
        participant.pop("population", None)
        for index, line in enumerate(lines):
            if '"kind":"participant_believes"' in line:
                event = json.loads(line)
                hidden = {"seq": event["seq"], "t_ns": event["t_ns"], "kind": "marker", "note": "-"}
                lines[index] = json.dumps(hidden, separators=(",", ":")) + "\n"
        folder = out / recording.name
        folder.mkdir(parents=True)
        (folder / "events.jsonl").write_text(json.dumps(header, separators=(",", ":")) + "\n" + "".join(lines))
        folders.append(folder)
    return folders
