"""The space bar stops the robot whatever the terminal sent before: beginnings of sequences that never end, halves of
characters, pastes without an end. And pasted text is no keys.

    tests/outside/space_bar.py TOMCOM FOLDER [--cases 1000]
"""

import argparse
import random
import sys
import time
from pathlib import Path

from console import Console, Log, session_file

SEED = 17
# After so much silence the input is in its first state; after a paste without an end, later.
SILENCE_S, UNENDED_S = 0.06, 1.1
# Sequences of which a beginning is sent: keys in several forms, mouse reports, answers to queries, characters of several bytes.
WHOLE = [
    b"\x1b[A", b"\x1bOP", b"\x1b[1;5C", b"\x1b[24~", b"\x1b[97:65;2:1u", b"\x1b[[A", b"\x1b[<35;120;40M", b"\x1b[M !!",
    b"\x1b]11;rgb:0000/0000/0000\x1b\\", b"\x1bP1$r0m\x1b\\", b"\x1b[?62;22c", "ß".encode(), "日".encode(), "🍣".encode(),
]

def prefix(rng):
    """Beginnings of sequences, in any order; none of them is a whole key."""
    chosen = [rng.choice(WHOLE) for _ in range(rng.randint(1, 3))]
    return b"".join(whole[:rng.randint(1, len(whole) - 1)] for whole in chosen)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--cases", type=int, default=1000)
    asked = parser.parse_args()
    session = session_file(asked.folder, kind="keyboard", gaze="none")
    rng, slowest = random.Random(SEED), 0.0
    with Console(asked.tomcom, [session, "--out", asked.folder / "recordings"]) as console:
        console.wait_for("READY")
        console.start()
        (recording,) = (asked.folder / "recordings").iterdir()
        log = Log(recording)

        def wait_for(event, what, again=b""):
            until, pressed = time.monotonic() + 60, time.monotonic()
            while not any(event in line for line in log.new_lines()):
                assert time.monotonic() < until, f"{what}: {event} did not come\n{console.text()}"
                time.sleep(0.002)
                if again and time.monotonic() > pressed + 0.3:
                    console.write(again)
                    pressed = time.monotonic()

        for case in range(asked.cases):
            before = prefix(rng)
            # Every fiftieth is a paste without an end, which has to be waited for.
            if case % 50 == 49:
                before = b"\x1b[200~call" + before
            console.write(before)
            time.sleep(UNENDED_S if before.startswith(b"\x1b[200~") else SILENCE_S)
            pressed = time.monotonic()
            console.write(b" ")
            wait_for(b"robot_stopped", f"case {case}, {before}")
            slowest = max(slowest, time.monotonic() - pressed)
            # After a lone escape the console asks whether to quit: the first key only closes that question.
            console.write(b"\x12")
            wait_for(b"robot_resumed", f"case {case}, {before}", again=b"\x12")
        log.new_lines()
        console.write(b"\x1b[200~please call me\x1b[201~")
        console.wait_for("pasted text is not taken for keys")
        time.sleep(1)
        keys = [line for line in log.new_lines() if b"robot_stopped" in line or b"signal_shown" in line or b'"agent":"human"' in line]
        assert not keys, keys
        console.quit()
    print(f"space bar: {asked.cases} random beginnings, each followed by one stop, the slowest after {1000 * slowest:.0f} ms", flush=True)


if __name__ == "__main__":
    sys.exit(main())
