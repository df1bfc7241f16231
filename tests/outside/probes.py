"""Analyses a study with probes and computes its figures once more with scikit-learn and pandas, from probes.csv and trials.csv alone.

    probes.py TOMCOM SCRATCH

Simulated participants answer from what they believe, with a share of wrong answers. From the tables: weighted areas under the ROC, the
calibration error and its bins, accuracies by group, log scores, the share of wrong answers of each trial. Then the participants are made
people, by taking their recorded beliefs out of the recordings: `tomcom-research beliefs` must give the same figures from their answers.
"""

import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from simulated import as_people, recordings_in, run, shortened
from sklearn.calibration import calibration_curve
from sklearn.metrics import log_loss, roc_auc_score

EXACT = 1e-6
ROUNDED = 1e-4
SESSION = Path("sessions/paper.toml")
PRESSES = 200


def near(what, found, wanted, by=EXACT):
    assert found is not None and abs(found - wanted) <= by * max(1.0, abs(wanted)), f"{what}: {found} instead of {wanted}"


def simulate(tomcom, folder):
    """The study of the paper with probes, shorter trials, and fewer participants."""
    probes = "\n[probes]\nper_trial = 4\napart_s = 45\nlevel_2 = true\nconfidence = true\n"
    session = shortened(SESSION, folder / "study.toml", PRESSES, probes)
    out = folder / "recordings"
    run(tomcom, "simulate", session, "--trials", 12, "--seed", 7, "--out", out, "--format", "json")
    return out


def study(tomcom, recordings):
    out = recordings.parent / f"{recordings.name}-study"
    shutil.rmtree(out, ignore_errors=True)
    figures = json.loads(run(tomcom, "study", recordings, "--skip", "concepts", "--out", out, "--format", "json"))
    return figures, {path.stem: pd.read_csv(path, keep_default_na=False, na_values=[""]) for path in out.glob("*.csv")}


def main_results(tables):
    """Questions of the main results in trials that count."""
    probes = tables["probes"].merge(tables["trials"][["recording", "counts"]], on="recording", validate="many_to_one")
    chosen = probes[probes.counts & probes.in_main_results].copy()
    assert ((chosen.origin == "schedule") & ~chosen.response.isin(["missing", "skipped"])).all()
    chosen["wrong"] = chosen.wrong.astype(bool)
    unsure = chosen.response == "unsure"
    assert chosen.wrong[unsure].all() and chosen.answer[unsure].isna().all()
    assert (chosen.wrong == (chosen.answer != chosen.truth)).all()
    assert np.allclose(chosen.weight * chosen.inclusion, 1.0) and chosen.inclusion.between(0.0499, 1).all()
    return probes, chosen


def areas(rows):
    score = rows.estimate_p_false
    is_recipe = rows.kind == "recipe"
    area = lambda of, score: roc_auc_score(rows.wrong[of], score[of], sample_weight=rows.weight[of])  # noqa: E731
    changed = rows.changed_unseen.map({True: 1.0, False: 0.0})
    places, recipes = area(~is_recipe, score), area(is_recipe, score)
    return {"auc_locations": places, "auc_recipes": recipes, "auc": (places + recipes) / 2, "auc_baseline": area(~is_recipe, changed)}


def calibration(rows, bins):
    """The weighted calibration error, and the bins that scikit-learn makes of as many copies of each row as it weighs."""
    inside = rows[rows.estimate_p_false.between(0.05, 0.95)]
    edges = np.minimum(((inside.estimate_p_false - 0.05) / 0.9 * 10).astype(int), 9)
    error = 0.0
    for number, rows_in in inside.groupby(edges):
        mean = lambda values: np.average(values, weights=rows_in.weight)  # noqa: E731
        predicted, observed = mean(rows_in.estimate_p_false), mean(rows_in.wrong)
        near("predicted", bins[number]["predicted"], predicted)
        near("observed", bins[number]["observed"], observed)
        assert bins[number]["n"] == len(rows_in)
        error += rows_in.weight.sum() * abs(predicted - observed)
    # Copies: weights times 1000, rounded.
    copies = inside.loc[inside.index.repeat((inside.weight * 1000).round().astype(int))]
    scaled = (copies.estimate_p_false - 0.05) / 0.9
    observed, predicted = calibration_curve(copies.wrong, scaled, n_bins=10)
    filled = [one for one in bins if one["n"] > 0]
    for one, share, mean in zip(filled, observed, predicted, strict=True):
        near("share of wrong answers by scikit-learn", one["observed"], share, 1e-3)
        near("mean prediction by scikit-learn", one["predicted"], mean * 0.9 + 0.05, 1e-3)
    return error / inside.weight.sum()


def check_detection(found, rows):
    for name, wanted in areas(rows).items():
        near(name, found[name], wanted)
    near("ece", found["ece"], calibration(rows, found["calibration"]["bins"]))
    near("share of wrong answers", found["wrong"], np.average(rows.wrong, weights=rows.weight))


def check_scores(scores, rows):
    named = rows[rows.answer.notna()]
    assert scores["n"] == len(named)
    near("log score", scores["estimate"], np.average(np.log(named.estimate_p_answer), weights=named.weight))
    # A forecast of "right" or "wrong" is a binary log loss, and what is wrong is spread over the other values.
    for name, point in [("usual", named.usual), ("last_seen", named.last_seen), ("truth", named.truth)]:
        right = named.answer == point
        rate = np.empty(len(named))
        for index, row in enumerate(named.itertuples()):
            others = (named.participant != row.participant) & ((named.kind == "recipe") == (row.kind == "recipe"))
            rate[index] = (right[others].sum() + 1) / (others.sum() + 2)
        spread = np.where(right, 0.0, np.log(named["values"] - 1))
        loss = log_loss(right, rate, sample_weight=named.weight, labels=[False, True])
        near(f"log score of {name}", scores[name], -loss - np.average(spread, weights=named.weight))


def check_accuracies(found, rows, trials):
    by = {one["group"]: one for one in found["accuracies"] if one["by"] in ("kind", "aspect", "condition", "seen")}
    groups = [(rows.kind == kind, name) for kind, name in [("order", "orders"), ("recipe", "recipes"), ("place", "other places")]]
    groups += [(rows.aspect == aspect, aspect) for aspect in rows.aspect.unique()]
    groups += [(rows.condition == condition, condition) for condition in rows.condition.unique()]
    seen = rows.changed_unseen.map({True: 1, False: 0})
    groups += [(seen == 1, "changed by others since the last look"), (seen == 0, "not changed by others since the last look")]
    for of, name in groups:
        one = by[name]
        assert one["n"] == of.sum() > 0, name
        near(name, one["accuracy"], np.average(~rows.wrong[of], weights=rows.weight[of]))
    for recording, own in rows.groupby("recording"):
        trial = trials[trials.recording == recording].iloc[0]
        assert trial.probe_questions == len(own)
        near(recording, trial.probes_wrong, np.average(own.wrong, weights=own.weight))


def main():
    tomcom, scratch = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    shutil.rmtree(scratch, ignore_errors=True)
    recordings = simulate(tomcom, scratch)
    figures, tables = study(tomcom, recordings)
    found = figures["probes"]
    assert found["beliefs_from"] == "probes"
    probes, rows = main_results(tables)
    counts = found["counts"]
    assert counts["questions"] == len(probes) and counts["counted"] == len(rows) > 100, counts
    assert counts["unsure"] == (rows.response == "unsure").sum()
    assert counts["unanswered"] == (probes.response == "missing").sum()
    assert counts["questions_skipped"] == (probes.response == "skipped").sum()
    near("effective", counts["effective"], rows.weight.sum() ** 2 / (rows.weight**2).sum())
    check_detection(found, rows)
    check_scores(found["log_scores"], rows)
    check_accuracies(found, rows, tables["trials"])
    # What simulated participants really believed, at the same questions.
    known = found["by_true_beliefs"]
    believed = rows.assign(wrong=rows.believed_p_truth < 0.5)
    assert known["n"] == len(rows) and rows.believed_p_truth.notna().all()
    near("agreement", known["agreement"], (believed.wrong == rows.wrong).mean())
    check_detection(known, believed)
    words = tables["dictionary"]
    assert set(tables["probes"].columns) == set(words[words.table == "probes"].column)
    assert "What people knew" in (recordings.parent / f"{recordings.name}-study" / "report.html").read_text()

    paths = as_people(recordings_in(recordings), scratch / "people")
    checked = json.loads(run(tomcom.with_name("tomcom-research"), "beliefs", *paths, "--format", "json"))
    assert checked["beliefs_from"] == "probes" and checked["probes"]["by_true_beliefs"] is None
    for name in ["auc", "auc_locations", "auc_recipes", "auc_baseline", "ece"]:
        near(f"{name} of people", checked[name], found[name])
        near(f"{name} of people", checked["probes"][name], found[name])
    print(f"probes: {len(rows)} questions, area {found['auc']:.3f} by answers, {known['auc']:.3f} by beliefs; all figures are as computed")


main()
