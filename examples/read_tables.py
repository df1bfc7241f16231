"""Reads the tables of `tomcom study` with pandas.

    python read_tables.py sessions/study

Prints the error rate by condition, the paired difference of every participant, and the errors by their causes.
"""

import sys
from pathlib import Path

try:
    import pandas
except ModuleNotFoundError as missing:
    sys.exit(f"{missing.name} is not installed: pip install pandas")


def main(folder):
    if not (Path(folder) / "trials.csv").exists():
        sys.exit(f"{folder} has no trials.csv: name the folder with the tables, such as {folder}/study")
    trials = pandas.read_csv(Path(folder) / "trials.csv")
    actions = pandas.read_csv(Path(folder) / "actions.csv", dtype={"cause": str})
    counted = trials[trials["counts"].astype(str).str.lower().isin(("true", "1"))]
    by_condition = counted.groupby("planned_arm")["error_rate_human"].agg(["count", "mean"])
    for condition, row in by_condition.iterrows():
        print(f"error_rate_human {condition}: {row['mean']:.6f} in {int(row['count'])} trials")
    # One row for each participant, one column for each condition.
    paired = counted.pivot_table(index="participant", columns="planned_arm", values="error_rate_human").dropna()
    if {"none", "wizard"} <= set(paired.columns):
        difference = paired["wizard"] - paired["none"]
        print(f"paired_difference: {difference.mean():.6f} over {len(difference)} participants")
    human = actions[(actions["agent"] == "human") & actions["recording"].isin(counted["recording"])]
    print("presses_human:", len(human))
    for cause, number in human["cause"].dropna().value_counts().sort_index().items():
        print(f"cause {cause}: {number}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
