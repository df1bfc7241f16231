"""Simulates a study of four arms, and compares its arms once more from the exported table, with other people's statistics.

    arms.py TOMCOM SCRATCH

Estimates and standard errors of the linear mixed model with statsmodels; where R has them, also the degrees of freedom and p with lmerTest, and
the negative binomial model with glmmTMB. Estimates to a thousandth of a standard error, p to a thousandth.
"""

import json
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import statsmodels.formula.api as smf
from simulated import run, shortened
from statsmodels.stats.multitest import multipletests

SESSION = Path("sessions/arms.toml")
ARMS = ["none", "wizard", "tom-com", "tom"]
PAIRS = [("wizard", "none"), ("tom-com", "none"), ("tom", "none"), ("tom-com", "wizard"), ("tom", "wizard")]
CLOSE = 1e-3

R = """
options(warn = -1)
suppressPackageStartupMessages({library(lmerTest); library(glmmTMB)})
d <- read.csv(commandArgs(TRUE)[1])
d$arm <- factor(d$study_arm, levels = c("none", "wizard", "tom-com", "tom"))
d$period <- factor(d$period)
linear <- lmer(log((errors + 0.5) / human_presses) ~ arm + period + (1 | participant), d)
counts <- glmmTMB(errors ~ arm + period + offset(log(human_presses)) + (1 | participant), d, family = nbinom2)
weights <- list(c(1, 0, 0), c(0, 1, 0), c(0, 0, 1), c(-1, 1, 0), c(-1, 0, 1))
for (w in weights) {
    l <- c(0, w, 0, 0, 0)
    one <- contest1D(linear, l)
    b <- fixef(counts)$cond; v <- vcov(counts)$cond
    estimate <- sum(l * b); se <- sqrt(as.numeric(t(l) %*% v %*% l))
    cat(one$Estimate, one$`Std. Error`, one$df, one$`Pr(>|t|)`, estimate, se, 2 * pnorm(-abs(estimate / se)), "\n")
}
"""


def simulate(tomcom, folder):
    """The study of arms with a scripted wizard, who sees no advice, and shorter trials."""
    session = shortened(SESSION, folder / "arms.toml", 120, '\n[wizard]\nkind = "scripted"\n')
    text = session.read_text().replace('["none", "wizard", "wizard+advice", "tom-com", "tom"]', json.dumps(ARMS))
    session.write_text(text.replace("block = 10", "block = 4"))
    run(tomcom, "simulate", session, "--seed", 71, "--out", folder / "recordings")
    return folder / "recordings"


def close(what, found, wanted, standard_error):
    assert abs(found - wanted) <= CLOSE * standard_error, f"{what}: {found} instead of {wanted}, standard error {standard_error}"


def main():
    tomcom, scratch = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    shutil.rmtree(scratch, ignore_errors=True)
    recordings = simulate(tomcom, scratch)
    figures = json.loads(run(tomcom, "study", recordings, "--skip", "concepts", "--format", "json", "--out", scratch / "study"))["arms"]
    trials = pd.read_csv(scratch / "study" / "trials.csv")
    assert (trials.study_arm == trials.planned_arm).all() and set(trials.wizard_sees) == {"state"}, trials
    assert list(figures["arms"][i]["arm"] for i in range(4)) == ARMS, figures
    for one in figures["arms"]:
        own = trials[trials.study_arm == one["arm"]]
        assert (one["events"], one["presses"], one["trials"]) == (own.errors.sum(), own.human_presses.sum(), len(own)), one

    # Williams: each arm in each place, and after each other arm, equally often.
    orders = trials.sort_values(["participant", "period"]).groupby("participant").study_arm.apply(list)
    follows = pd.Series([pair for order in orders for pair in zip(order, order[1:])]).value_counts()
    assert len(follows) == 12 and follows.nunique() == 1, follows

    trials["rate"] = np.log((trials.errors + 0.5) / trials.human_presses)
    trials["arm"] = pd.Categorical(trials.study_arm, ARMS)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = smf.mixedlm("rate ~ C(arm) + C(period)", trials, groups=trials.participant).fit(reml=True, method="powell", gtol=1e-12)
    place = {arm: 0 if index == 0 else index for index, arm in enumerate(ARMS)}
    names = list(model.fe_params.index)
    ps = [one["p"] for one in figures["contrasts"]]
    corrected = multipletests(ps, method="holm")[1]
    for one, pair, holm in zip(figures["contrasts"], PAIRS, corrected, strict=True):
        assert (one["arm"], one["against"]) == pair, one
        weights = np.zeros(len(names))
        for arm, sign in zip(pair, (1, -1)):
            if place[arm]:
                weights[place[arm]] += sign
        error = float(np.sqrt(weights @ model.cov_params().iloc[: len(names), : len(names)].to_numpy() @ weights))
        close(f"statsmodels, {pair}", one["estimate"], float(weights @ model.fe_params), error)
        assert abs(one["standard_error"] / error - 1) < 1e-3, (one, error)
        assert abs(one["p_holm"] - holm) < 1e-9, (one, holm)
    print(f"arms: {len(trials)} trials; statsmodels agrees on {len(PAIRS)} contrasts", flush=True)

    if shutil.which("Rscript") is None or subprocess.run(
        ["Rscript", "-e", "library(lmerTest); library(glmmTMB)"], capture_output=True
    ).returncode:
        print("arms: R with lmerTest and glmmTMB is not here; degrees of freedom and counts were not compared")
        return
    script = scratch / "arms.R"
    script.write_text(R)
    lines = [[float(word) for word in line.split()] for line in run("Rscript", script, scratch / "study" / "trials.csv").splitlines()]
    counts = figures["negative_binomial"]["contrasts"]
    for one, count, (estimate, error, df, p, of_counts, count_error, count_p) in zip(figures["contrasts"], counts, lines, strict=True):
        what = f"{one['arm']} to {one['against']}"
        close(f"lmerTest, {what}", one["estimate"], estimate, error)
        assert abs(one["p"] - p) < CLOSE and abs(one["df"] / df - 1) < 1e-2, (what, one, df, p)
        close(f"glmmTMB, {what}", count["estimate"], of_counts, count_error)
        assert abs(count["p"] - count_p) < CLOSE, (what, count, count_p)
    print(f"arms: lmerTest and glmmTMB agree on {len(lines)} contrasts each")


if __name__ == "__main__":
    main()
