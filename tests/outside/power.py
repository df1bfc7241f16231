"""Computes power and type I error once more from the pool's file, with studies that Python draws, and the digest of a frozen plan.

    power.py TOMCOM SCRATCH

The paper's test (the interaction of a mixed ANOVA) is Student's t between the two orders of arms on the differences of rates; the contrast of
the mixed model is, in two complete periods, the t of the same differences of logarithms, unless the variance between persons is estimated as zero.
Shares of rejections agree within four standard errors of both.
"""

import hashlib
import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

STUDIES = 2000
SIZE = 14
SEED = 71


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True)
    assert done.returncode == 0, f"{arguments}\n{done.stderr}"
    return done.stdout


def plan(folder):
    """The paper's plan with shorter trials."""
    text = Path("sessions/paper.toml").read_text().replace('"../', f'"{Path.cwd()}/').replace("presses = 304", "presses = 120")
    folder.mkdir(parents=True)
    file = folder / "short.toml"
    file.write_text(text)
    return file


def rejections(differences, random, persons, signs):
    """Shares of studies in which Student's t between the orders finds a difference; `persons(order)` are those to draw from."""
    found = 0
    for _ in range(STUDIES):
        groups = [differences[order][random.choice(persons(order), SIZE // 2)] * signs[order] for order in (0, 1)]
        found += stats.ttest_ind(*groups).pvalue < 0.05
    return found / STUDIES


def close(what, found, share, studies):
    error = np.sqrt(share * (1 - share) * (1 / STUDIES + 1 / studies)) + 1e-9
    assert abs(found - share) < 4 * error + 0.01, f"{what}: {found}, and by Python {share}"


def main():
    tomcom, scratch = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    shutil.rmtree(scratch, ignore_errors=True)
    session = plan(scratch)
    pool = scratch / "pool.jsonl"
    power = ["power", session, "--sizes", SIZE, "--studies", STUDIES, "--format", "json"]
    simulated = json.loads(run(tomcom, *power, "--pool", 60, "--seed", SEED, "--out", pool))
    null = json.loads(run(tomcom, *power, "--from", pool, "--effect", 1))
    lines = [json.loads(line) for line in pool.read_text().splitlines()]
    trials = pd.DataFrame(lines[1:])
    assert lines[0]["participants"] == 60 and len(trials) == 60 * 3, trials

    transforms = {
        "mixed_anova": lambda d: d.errors / d.human_presses,
        "linear_mixed_model": lambda d: np.log((d.errors + 0.5) / d.human_presses),
    }
    random = np.random.default_rng(SEED)
    for index, (method, transform) in enumerate(transforms.items()):
        trials["value"] = transform(trials)
        own = trials[trials.arm == trials.planned].pivot(index="participant", columns="period", values="value")
        twins = trials[trials.arm == "none"].pivot(index="participant", columns="period", values="value")
        group = trials.groupby("participant").group.first()
        orders = [np.flatnonzero(group == name) for name in ("AB", "BA")]
        ours = [found["sizes"][0]["tests"][index] for found in (simulated, null)]
        assert [one["method"] for one in ours] == [method] * 2, ours
        difference = (own[2] - own[1]).to_numpy()
        share = rejections([difference] * 2, random, lambda order: orders[order], [1, 1])
        close(f"power, {method}", ours[0]["share"], share, ours[0]["studies"])
        difference = (twins[2] - twins[1]).to_numpy()
        share = rejections([difference] * 2, random, lambda _: len(difference), [1, 1])
        close(f"type I error, {method}", ours[1]["share"], share, ours[1]["studies"])
        print(f"power: {method}: {ours[0]['share']:.3f} and {ours[1]['share']:.3f}, as by Python", flush=True)

    frozen = scratch / "short.frozen"
    told = json.loads(run(tomcom, "plan", session, "--out", scratch / "none", "--freeze", frozen, "--format", "json"))
    first, body = frozen.read_bytes().split(b"\n", 1)
    digest = hashlib.sha256(body).hexdigest()
    assert told["digest"] == digest and first.decode().endswith(digest), told
    content = json.loads(body)
    assert content["plan"] == "paper" and content["analysis"]["contrasts"] == [["wizard", "none"]], content["analysis"]
    print("power: the digest of the frozen plan is that of hashlib")


if __name__ == "__main__":
    main()
