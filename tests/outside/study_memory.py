"""Resident memory of `tomcom study` with few and with many trials, and with the same trials in parts.

    tests/outside/study_memory.py TOMCOM FOLDER [--trials 280] [--presses 16] [--more 1.4] [--seed 8106]

The trials are short, since memory is held against their number: unassisted trials with what concepts would have prevented, and trials of a
scripted wizard with the signals that the assistant would have sent.
"""

import argparse
import os
import subprocess
from pathlib import Path

from simulated import run, shortened

FEW = 28


def peak_mb(*command):
    """Largest resident memory of a command in MB."""
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    assert status == 0, f"{command}: {status}"
    return usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--trials", type=int, default=280)
    parser.add_argument("--presses", type=int, default=16, help="of both agents in a trial")
    parser.add_argument("--more", type=float, default=1.4, help=f"how many times the memory of {FEW} trials may be needed")
    parser.add_argument("--seed", type=int, default=8106)
    arguments = parser.parse_args()
    tomcom, folder, trials = arguments.tomcom, arguments.folder / f"study-memory-{os.getpid()}", arguments.trials
    session = shortened("sessions/paper.toml", folder / "sessions" / "many.toml", arguments.presses)
    session.write_text(session.read_text().replace("participants = 14", f"participants = {14 * -(-trials // FEW)}"))
    run(tomcom, "simulate", session, "--seed", arguments.seed, "--trials", trials, "--out", folder / "recordings")
    recordings = sorted((folder / "recordings").iterdir())
    assert len(recordings) == trials, f"{len(recordings)} recordings"
    few = peak_mb(tomcom, "study", *recordings[:FEW], "--out", folder / "few")
    many = peak_mb(tomcom, "study", folder / "recordings", "--out", folder / "many")
    part = peak_mb(tomcom, "study", folder / "recordings", "--shard", "1/1", "--out", folder / "part.jsonl")
    joined = peak_mb(tomcom, "study", "--from", folder / "part.jsonl", "--out", folder / "joined")
    print(f"study of {FEW} trials: {few:.0f} MB; of {trials}: {many:.0f} MB; as one part: {part:.0f} MB, joined: {joined:.0f} MB")
    for name in ("trials.csv", "concepts.csv", "report.html"):
        assert (folder / "many" / name).read_bytes() == (folder / "joined" / name).read_bytes(), f"{name} differs"
    for megabytes in (many, part, joined):
        assert megabytes <= arguments.more * few, f"more than {arguments.more} times as much"


if __name__ == "__main__":
    main()
