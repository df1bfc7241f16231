"""Reads a recording with the Python package of tomcom, which needs pandas alone.

    pip install tomcom-*.whl            # or: export PYTHONPATH=packaging/python
    python examples/read_recording.py sessions/2026-03-14-P07-1

Prints who took part, how the trial went, and where gaze was.
"""

import sys

try:
    import pandas  # noqa: F401
    import tomcom
except ModuleNotFoundError as missing:
    sys.exit(
        f"{missing.name} is not installed: pip install pandas tomcom-*.whl, with the wheel of tomcom's release (.ci/package makes it); "
        "or, with tomcom's sources, pip install pandas and export PYTHONPATH=…/packaging/python"
    )


def main(recording):
    trial = tomcom.read(recording)
    events, presses, gaze = trial.events, trial.presses, trial.gaze
    human = presses[presses["agent"] == "human"]
    print("participant:", trial.participant)
    print("condition:", trial.condition)
    print("events:", sum(1 for _ in trial.log()))
    print("trial_s:", round(max(events["trial_s"].max(), gaze["trial_s"].max()), 3))
    print("presses_human:", len(human))
    print("presses_robot:", len(presses) - len(human))
    print("signals:", len(trial.signals))
    print("orders:", len(trial.orders))
    if len(human) > 1:
        print("median_s_between_presses:", round(human["trial_s"].diff().median(), 3))
        print("most_pressed:", human["button"].value_counts().sort_index().idxmax())
    if len(gaze):
        seen = gaze[gaze["confidence"] >= 0.6]
        print("gaze_samples:", len(gaze))
        print("gaze_on_display:", round(float((seen["x"].between(0, 1) & seen["y"].between(0, 1)).mean()), 3))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
