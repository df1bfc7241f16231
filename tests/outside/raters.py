"""Analyses a study of people whose errors two raters have coded, and computes the figures once more with scikit-learn and pandas.

    raters.py TOMCOM SCRATCH

The people are simulated participants whose recorded beliefs are taken out of the recordings; the raters name the true cause of nine
errors of ten. From the tables and logs alone: agreement and kappa, how far raters share false beliefs, areas under the curves of the
concepts, what proposals of DEV would have prevented, the wizard's hits and omissions. The raters' names must not matter, and which two of
three count is asked.
"""

import json
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from simulated import as_people, recordings_in, run, shortened
from sklearn.metrics import auc, cohen_kappa_score

EXACT = 1e-6
RIGHT = 0.9
PRESSES = 120
SESSION = Path("sessions/paper.toml")
OTHER = [("slip", ""), ("race", ""), ("other", ""), ("buttons", "")]


def near(what, found, wanted):
    assert found is not None and abs(found - wanted) <= EXACT * max(1.0, abs(wanted)), f"{what}: {found} instead of {wanted}"


def simulate(tomcom, folder, seed):
    """The study of the paper, with shorter trials and fewer participants."""
    session = shortened(SESSION, folder / "study.toml", PRESSES)
    out = folder / "recordings"
    run(tomcom, "simulate", session, "--trials", 12, "--seed", seed, "--out", out, "--format", "json")
    return out


def study(tomcom, recordings, *more):
    out = recordings.parent / f"{recordings.name}-study"
    shutil.rmtree(out, ignore_errors=True)
    figures = json.loads(run(tomcom, "study", recordings, "--out", out, "--format", "json", *more))
    return figures, {path.stem: pd.read_csv(path, keep_default_na=False, na_values=[""]) for path in out.glob("*.csv")}


def true_code(row):
    """What a rater who knows everything says about an error."""
    order = re.search(r" of (order \d)$", str(row.aspect))
    match row.cause:
        case "slip":
            return ("slip", "")
        case "belief" if order:
            return ("belief", order[1].replace(" ", "_"))
        case "belief" if not row.aspect.startswith("recipe of "):
            return ("belief", row.aspect.replace(" ", "_"))
        case _:
            return ("other", "")


def people(simulated, actions, out, raters):
    """Recordings of people, with the codes of these raters beside them."""
    for folder in as_people(recordings_in(simulated), out):
        head = (folder / "events.jsonl").read_text().splitlines()[0]
        layout = [name for name in re.findall(r'name = \\"(\w+)\\"', head)]
        errors = actions[(actions.recording == folder.name) & (actions.error == True)]  # noqa: E712
        places = sorted({code[1] for code in map(true_code, errors.itertuples()) if code[1]} & set(layout))
        for rater in raters:
            chance = random.Random(f"{folder.name} {rater}")
            rows = ["rater,press,cause,aspect"]
            for row in errors.itertuples():
                code = true_code(row)
                if chance.random() >= RIGHT:
                    code = chance.choice([one for one in OTHER + [("belief", place) for place in places] if one != code])
                rows.append(f"{rater},{row.seq},{code[0]},{code[1]}")
            (folder / f"codes-{rater}.csv").write_text("\n".join(rows) + "\n")


def rename(folder, rater, other, keep=False):
    """Gives the codes of a rater to another one: the file says inside whose it is."""
    own = folder / f"codes-{rater}.csv"
    text = own.read_text().replace(f"\n{rater},", f"\n{other},")
    (folder / f"codes-{other}.csv").write_text(text)
    if not keep:
        own.unlink()


def without_names(figures):
    """The figures without the names of the raters."""
    return {key: value for key, value in figures.items() if key not in ("rater_pairs", "identical_codes")}


def check_agreement(figures, trials, actions):
    errors = actions[(actions.agent == "human") & (actions.error == True)]  # noqa: E712
    kinds = [errors[column].str.split(" ").str[0] for column in ("rater_1", "rater_2")]
    beliefs = errors[(kinds[0] == "belief") & (kinds[1] == "belief")]
    found = figures["raters"]
    assert (found["errors"], found["same_cause"]) == (len(errors), int((kinds[0] == kinds[1]).sum()))
    near("kappa of causes", found["kappa_cause"], float(cohen_kappa_score(*kinds)))
    near("kappa of aspects", found["kappa_aspect"], float(cohen_kappa_score(beliefs.rater_1, beliefs.rater_2)))
    same = beliefs[beliefs.rater_1 == beliefs.rater_2]
    of_one = errors[(kinds[0] == "belief") != (kinds[1] == "belief")]
    wanted = {"same": len(same), "differing": len(beliefs) - len(same), "of_one": len(of_one)}
    assert figures["shared_beliefs"] == wanted, (figures["shared_beliefs"], wanted)
    assert (errors.cause == "belief").sum() == len(beliefs) == figures["belief_related_errors"]
    # Every error of which both say the same lies in an episode, and no other does.
    assert set(errors[errors.false_since_s.notna()].index) == set(same.index)
    assert (same.false_since_s <= same.time_s + EXACT).all()
    assert (same.false_until_s.fillna(np.inf) >= same.time_s - EXACT).all()
    for trial in trials.itertuples():
        own = same[same.recording == trial.recording]
        assert trial.beliefs_from == "raters" and trial.raters_same_belief == len(own), trial


def proposals(errors, shared, k):
    """Proposals of k presses after every error that none spares: their number, errors prevented, useless ones."""
    count, after = np.zeros(3, int), 0
    while after < len(errors):
        after += 1
        if errors[after - 1]:
            spared = slice(after, after + k)
            count += [1, int(shared[spared].sum()), int(not errors[spared].any())]
            after = min(after + k, len(errors))
    return count


def check_concepts(figures, tables):
    actions, concepts = tables["actions"], tables["concepts"]
    assert figures["roc_beliefs_from"] == "raters" and set(concepts.beliefs_from) == {"raters"}
    assert concepts.harmless.isna().all() and all(one["harmless"] is None for roc in figures["roc"] for one in roc["points"])
    for recording, own in concepts.groupby("recording"):
        human = actions[(actions.recording == recording) & (actions.agent == "human")]
        shared = ((human.rater_1 == human.rater_2) & human.rater_1.fillna("").str.startswith("belief")).to_numpy()
        assert set(own.related) == {int(shared.sum())} and set(own.presses) == {len(human)}
        for row in own[own.concept == "dev"].itertuples():
            found = proposals((human.error == True).to_numpy(), shared, int(row.parameter))  # noqa: E712
            assert list(found) == [row.signals, row.prevented, row.useless], (recording, row, found)
    counts = concepts.groupby(["concept", "parameter"], sort=False)[["presses", "related", "prevented", "useless"]].sum()
    points = counts.reset_index().assign(fpr=lambda d: d.useless / d.presses, tpr=lambda d: d.prevented / d.related)
    common = min(own.fpr.max() for _, own in points.groupby("concept"))
    near("common range", figures["roc_common_fpr"], float(common))
    for roc in figures["roc"]:
        curve = points[points.concept == roc["concept"]].sort_values(["fpr", "tpr"])[["fpr", "tpr"]].to_numpy()
        curve = np.vstack([[0, 0], curve])
        highest = pd.DataFrame(curve).groupby(0)[1].max()
        end = float(np.interp(common, highest.index, highest))
        inside = np.vstack([curve[curve[:, 0] < common], [common, end]])
        near(f"area of {roc['concept']}", roc["auc"], float(auc(inside[:, 0], inside[:, 1])) / common)


def dishes(recording):
    """What an order shows from when on, in seconds of the trial's clock."""
    shown, start = [], None
    for line in (recording / "events.jsonl").open():
        if '"kind":"trial_started"' in line:
            start = json.loads(line)["t_ns"]
        elif '"kind":"order_shown"' in line:
            event = json.loads(line)
            shown.append(((event["t_ns"] - start) / 1e9, event["order"].replace("_", " "), event["dish"]))
    return shown


def check_wizard(figures, tables, recordings):
    """Hits: episodes with a signal about them. An error about "recipe of tuna maki (order 1)" is one about this order or about this recipe."""
    actions, said, trials = tables["actions"], tables["communications"], tables["trials"]
    hits = omissions = 0
    for trial in trials[trials.condition == "wizard"].itertuples():
        errors = actions[(actions.recording == trial.recording) & actions.false_since_s.notna()]
        errors = errors.assign(false_until_s=errors.false_until_s.fillna(np.inf))
        signals = said[(said.recording == trial.recording) & (said.lane == "wizard")]
        shown = dishes(recordings / trial.recording)
        spells = errors.groupby(["false_since_s", "false_until_s", "aspect"]).size().reset_index()
        hit = 0
        for spell in spells.itertuples():
            # A signal that mends the belief falls into the episode, one that showed it right before does not. Times have four digits.
            inside = signals[(signals.time_s > spell.false_since_s + 1e-4) & (signals.time_s <= spell.false_until_s + 1e-4)]
            about = set()
            for signal in inside.itertuples():
                target = signal.target.replace("_", " ")
                on_it = [dish for time, order, dish in shown if order == target and time <= signal.time_s]
                about |= {target, f"recipe of {on_it[-1]}" if on_it else target}
            hit += any(spell.aspect == one or spell.aspect.startswith(one) or spell.aspect.endswith(f"({one})") for one in about)
        assert (trial.wizard_hits, trial.wizard_hits + trial.wizard_omissions) == (hit, len(spells)), (trial.recording, hit, spells)
        hits, omissions = hits + trial.wizard_hits, omissions + trial.wizard_omissions
    wizard = figures["wizard"]
    assert figures["wizard_beliefs_from"] == "raters" and (wizard["hits"], wizard["omissions"]) == (hits, omissions)
    assert wizard["needless"] is None and wizard["harmless"] is None and wizard["wrong_targets"] is None


def main():
    tomcom, scratch = Path(sys.argv[1]), Path(sys.argv[2])
    shutil.rmtree(scratch, ignore_errors=True)
    simulated = simulate(tomcom, scratch / "simulated", 13)
    truth, tables = study(tomcom, simulated)
    coded = scratch / "people"
    people(simulated, tables["actions"], coded, ["R1", "R2"])
    figures, tables = study(tomcom, coded)
    check_agreement(figures, tables["trials"], tables["actions"])
    check_concepts(figures, tables)
    check_wizard(figures, tables, coded)

    # The raters' names do not matter.
    renamed = scratch / "renamed"
    shutil.copytree(coded, renamed)
    for folder in renamed.iterdir():
        rename(folder, "R1", "Z")
    again, _ = study(tomcom, renamed)
    assert list(again["rater_pairs"]) == ["R2+Z"] and list(figures["rater_pairs"]) == ["R1+R2"]
    assert without_names(again) == without_names(figures), "the figures depend on the raters' names"

    # Of three raters who coded everything the program does not choose two.
    for folder in renamed.iterdir():
        rename(folder, "Z", "R0", keep=True)
    refused = subprocess.run([tomcom, "study", renamed, "--skip", "concepts"], capture_output=True, text=True)
    assert refused.returncode != 0 and "R0, R2, Z" in refused.stderr and "--raters" in refused.stderr, refused.stderr
    again, _ = study(tomcom, renamed, "--raters", "Z", "R2")
    assert without_names(again) == without_names(figures), "two named raters count as two alone do"
    areas = [" ".join(f"{roc['concept']} {roc['auc']:.3f}" for roc in one["roc"]) for one in (truth, figures)]
    print(f"raters' figures agree with scikit-learn; areas by the truth: {areas[0]}, by two raters: {areas[1]}")


main()
