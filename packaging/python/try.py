"""Tries the installed wheel: `python try.py FOLDER` makes a lab there, simulates 30 s, and reads what was recorded."""

import sys
from pathlib import Path

import pandas

import tomcom


def main(folder: Path) -> None:
    print(tomcom.run("new", folder))
    session = folder / "sessions" / "short.toml"
    text = (folder / "sessions" / "probes.toml").read_text("utf-8")
    for was, is_now in [("seconds = 240.0", "seconds = 30.0"), ("per_trial = 3", "per_trial = 1"), ("apart_s = 40.0", "apart_s = 5.0")]:
        assert was in text, was
        text = text.replace(was, is_now)
    session.write_text(text, "utf-8")
    one, two = tomcom.simulate(session, trials=2, seed=3, arm="timed", condition="assistant", out=folder / "pilot")
    assert [trial.path for trial in tomcom.recordings(folder / "pilot")] == [one.path, two.path]
    assert (one.condition, one.excluded) == ("assistant", False)
    presses, events = one.presses, one.events
    assert len(presses) > 10 and presses["trial_s"].is_monotonic_increasing and presses["trial_s"].max() < 30.001
    assert set(presses["agent"]) == {"human", "robot"} and len(presses) == (events["kind"] == "press").sum()
    own = one.beliefs[one.beliefs["source"] == "participant"]
    assert own["p_truth"].between(0, 1).all() and own.groupby("seq").size().nunique() == 1
    probed = sum(event["did"] == "begun" for event in one.log("probe"))
    assert own["seq"].nunique() == (presses["agent"] == "human").sum() + probed and probed == 1
    assert one.gaze["x"].notna().all() and str(one.signals["offer"].dtype) == "Int64"
    for table in (one.signals, one.probes, one.orders):
        assert isinstance(table, pandas.DataFrame) and {"seq", "t_s", "trial_s"} <= set(table)
    asked = pandas.concat([one.probes, two.probes])
    assert len(asked) >= 2 and asked["answered_s"].ge(asked["t_s"]).all() and set(asked["on"]) == {"display"}, asked
    study = tomcom.study(folder / "pilot", skip="concepts")
    counted = study.trials.set_index("recording")["human_presses"]
    assert counted[one.path.name] == (presses["agent"] == "human").sum(), counted
    assert study.report.exists()
    for wrong, says in [(lambda: study.nothing, "there are: actions"), (lambda: tomcom.run("kitchen", "none"), "cannot be read")]:
        try:
            wrong()
        except (AttributeError, tomcom.ProgramFailed) as error:
            assert says in str(error), error
        else:
            raise AssertionError(f"nothing was refused that should say {says!r}")
    print(f"{len(presses)} presses, {len(one.gaze)} samples of gaze, {len(own)} beliefs; all of it holds")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
