"""Holds the stream for Rerun against the log that it was made of: Rerun's own tools read it, and rows are counted anew.

    stream.py PATH_OF_tomcom SCRATCH_FOLDER
"""

import json
import subprocess
import sys
from collections import Counter
from importlib.util import find_spec
from pathlib import Path

from kitchen import Kitchen, Trial
from rerun.experimental import RrdReader

RERUN = Path(find_spec("rerun_sdk").submodule_search_locations[0]) / "rerun_cli" / "rerun"
LEAST_PRESSES = 20
FALSE_BELOW = 0.5
# Number of curves and marks with a colour of their own; time after a curve's end from which another one may have it.
COLOURS = 6
APART_NS = 60_000_000_000
# Time for which a belief is false before its curve begins; period of the curve's rows between presses.
LASTING_NS = 1_000_000_000
SHOWN_EVERY_NS = 200_000_000


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def rows_of(path, timeline="session_time"):
    """For every entity, the (time in ns on this timeline, step) of every row that is not static."""
    rows = {}
    for chunk in RrdReader(path).stream():
        if chunk.is_static or str(chunk.entity_path).startswith("/__"):
            continue
        batch = chunk.to_record_batch()
        names = batch.schema.names
        if timeline not in names:
            continue
        times = batch.column(timeline).cast("int64").to_pylist()
        steps = batch.column("step").to_pylist()
        rows.setdefault(str(chunk.entity_path).strip("/"), []).extend(zip(times, steps))
    return {entity: sorted(places) for entity, places in rows.items()}


def expected(log):
    """What the log says: for every entity, the (time, number) of the events that change it; and for curves and marks of beliefs,
    P(truth) by the (time, number) of the events that tell it."""
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    header, events = lines[0], lines[1:]
    kitchen = Kitchen(header["layout"]["text"], header["recipes"]["text"])
    trial = Trial(kitchen)
    found, beliefs, running, shown = {}, {}, False, {}
    places = [*kitchen.orders, *trial.content]
    # How everything is at the beginning.
    for place in places:
        found.setdefault(f"kitchen/{place}", []).append((0, 0))
    contents = lambda: dict(trial.content) | {order: shown.get(order) for order in kitchen.orders}
    for event in events:
        at, before = (event["t_ns"], event["seq"]), contents()
        add = lambda entity: found.setdefault(entity, []).append(at)
        match event["kind"]:
            case "trial_started" | "trial_resumed" as kind:
                running = True
                if kind == "trial_started":
                    add("assistant/benefit/cost_line")
            case "trial_paused" | "trial_ended" | "trial_aborted":
                running = False
            case "gaze":
                add("human/gaze")
            case "press" if running:
                add(f"{event['agent']}/presses")
                _, served = trial.press(event["agent"], event["button"])
                if served:
                    shown[served] = "served"
            case "order_shown":
                trial.wanted[event["order"]] = shown[event["order"]] = event["dish"]
            case "order_cleared":
                shown[event["order"]] = None
            case "signal_shown":
                add(f"{event['by']}/signals")
            case "signal_ended" if event["reason"] == "taken_back":
                add("wizard/signals")
            case "advised":
                add("assistant/benefit/cost_line")
            case "robot_moves":
                add("robot/force")
            case "belief_estimated" | "participant_believes" as kind:
                whose = "estimated" if kind == "belief_estimated" else "true"
                for aspect in event["aspects"]:
                    entity = f"human/belief/{whose}/" + aspect["aspect"].replace(" ", "_")
                    beliefs.setdefault(entity, {})[at] = aspect["p_truth"]
        for place, content in contents().items():
            if content != before[place]:
                add(f"kitchen/{place}")
    return found, beliefs


def column(stream, top, name):
    """The (entity, (time in ns, step), value) of each row of a column, of the entities below `top`."""
    for chunk in RrdReader(stream).stream():
        entity, batch = str(chunk.entity_path).strip("/"), chunk.to_record_batch()
        if not chunk.is_static and entity.startswith(top) and name in batch.schema.names:
            places = zip(batch.column("session_time").cast("int64").to_pylist(), batch.column("step").to_pylist())
            yield from ((entity, place, value) for place, value in zip(places, batch.column(name).to_pylist()))


def curves_of(stream):
    """For every curve and every mark of beliefs, the values by place, at a press that before it, and the places at which a curve
    ends."""
    values, ends = {}, {}
    for entity, place, value in column(stream, "human/belief/", "Scalars:scalars"):
        if value:
            values.setdefault(entity, {}).setdefault(place, value[0])
        elif value is not None:
            ends.setdefault(entity, set()).add(place)
    return values, ends


def bars_of(stream):
    """For every aspect, the (beginning, end) in ns of the bars of false beliefs."""
    states = {}
    for entity, (time, _), words in column(stream, "wrong_belief/", "StateChange:state"):
        states.setdefault(entity.split("/")[-1], []).append((time, words))
    bars = {}
    for aspect, changes in states.items():
        changes.sort()
        bars[aspect] = [(at, end) for (at, [words]), (end, _) in zip(changes, changes[1:]) if words]
    return bars


def compare_curves(stream, wanted):
    """Curves and marks have the values of the log. `wanted`: for each aspect, the P(truth) of the log by place. A curve begins
    where a belief has been false for a second, goes on until it ends, and a mark stands wherever a belief is false; but only six
    aspects have a colour at a time."""
    values, ends = curves_of(stream)
    times = {}
    for entity, rows in values.items():
        times.setdefault(entity.split("/")[-1], []).extend(time for time, _ in rows)

    def has_no_colour(aspect, at):
        others = {one for one, seen in times.items() if one != aspect and any(0 <= at - time <= APART_NS for time in seen)}
        return len(others) >= COLOURS

    compared = 0
    for entity, logged in wanted.items():
        rows, aspect = values.get(entity, {}), entity.split("/")[-1]
        steps = {step for _, step in logged}
        at_presses = {place: value for place, value in rows.items() if place[1] in steps}
        for place, value in at_presses.items():
            assert abs(value - logged[place]) < 1e-6, f"{entity} at {place}: {value}, the log says {logged[place]}"
        between = len(rows) - len(at_presses)
        is_estimate = "/estimated/" in entity
        # Between presses the estimate is shown five times a second.
        assert not is_estimate or between >= len(at_presses) / 10, f"{entity}: {between} rows between presses"
        assert is_estimate or between == 0, f"{entity}: {between} marks that are not of the log"
        for place, value in logged.items():
            drawn = max((row for row in rows if row < place), default=None)
            goes_on = drawn is not None and not any(drawn <= end < place for end in ends.get(entity, ()))
            is_due = goes_on if is_estimate else value < FALSE_BELOW
            if place in at_presses or not is_due:
                continue
            assert not is_estimate and has_no_colour(aspect, place[0]), f"{entity}: nothing at {place}, where P(truth) is {value}"
        compared += len(at_presses)
    for aspect, bars in bars_of(stream).items():
        rows = [time for time, _ in values.get(f"human/belief/estimated/{aspect}", {})]
        for at, end in bars:
            begins = at + LASTING_NS
            is_drawn = any(begins <= time <= end + SHOWN_EVERY_NS for time in rows)
            assert end - begins < SHOWN_EVERY_NS or is_drawn or has_no_colour(aspect, end), f"{aspect}: no curve from {at} to {end} ns"
    assert compared > LEAST_PRESSES, f"only {compared} values of beliefs to compare"
    return compared


def compare(stream, log, least_presses=LEAST_PRESSES):
    rows, (wanted, beliefs) = rows_of(stream), expected(log)
    assert len(wanted["human/presses"]) >= least_presses, "too few presses to compare anything"
    for entity, places in sorted(wanted.items()):
        got = rows.get(entity, [])
        assert got == sorted(places), f"{entity}: {len(got)} rows, {len(places)} events; {set(got) ^ set(places)}"
    compared = compare_curves(stream, beliefs)
    print(f"  {len(wanted)} entities, {sum(map(len, wanted.values()))} rows and {compared} beliefs as the log has them")


def values(stream):
    """Every row of a stream with its values, without the ids that Rerun gives rows."""
    found = {}
    for chunk in RrdReader(stream).stream():
        batch = chunk.to_record_batch()
        names = [name for name in batch.schema.names if "row_id" not in name.lower() and "rowid" not in name.lower()]
        columns = [batch.column(name).to_pylist() for name in names]
        rows = (repr(sorted(zip(names, map(repr, row)))) for row in zip(*columns))
        found.setdefault(str(chunk.entity_path), []).extend(rows)
    return {entity: sorted(rows) for entity, rows in found.items()}


def same_of_the_same_seed(tomcom, scratch):
    """Two runs with the same seed: the same log byte for byte, and the same rows in the stream."""
    first, second = scratch / "first", scratch / "second"
    for out in (first, second):
        run(tomcom, "simulate", "sessions/default.toml", "--seed", "7", "--arm", "timed", "--rerun", "--out", out)
    logs = [next(out.iterdir()) / "events.jsonl" for out in (first, second)]
    assert logs[0].read_bytes() == logs[1].read_bytes()
    one, other = (values(log.with_name("recording.rrd")) for log in logs)
    differing = [entity for entity in one.keys() | other.keys() if one.get(entity) != other.get(entity)]
    assert one and not differing, f"the same seed gives other rows: {differing}"
    print(f"  {sum(map(len, one.values()))} rows, the same again with the same seed")


def on_trials_clock(stream):
    """A simulated trial begins with its session and is never paused: both clocks are the same, but for milliseconds, and lines
    of lists, which are told with tenths of a second."""
    session, trial = rows_of(stream), rows_of(stream, "trial_clock_time")
    assert session.keys() == trial.keys()
    for entity, rows in trial.items():
        ends = max(time for time, _ in rows), max(time for time, _ in session[entity])
        assert all(time % 1_000_000 == 0 for time, _ in rows), f"{entity}: not in milliseconds"
        assert ends[0] < ends[1] + 100_000_000, f"{entity}: {ends}"


def main():
    tomcom, scratch = sys.argv[1], Path(sys.argv[2])
    run(RERUN, "analytics", "disable")
    for session in ("default", "burger"):
        out = scratch / session
        run(tomcom, "simulate", f"sessions/{session}.toml", "--trials", "1", "--condition", "assistant", "--rerun", "--out", out)
        (recording,) = out.iterdir()
        stream, log = recording / "recording.rrd", recording / "events.jsonl"
        print(f"{session}: {stream.stat().st_size / 1e6:.1f} MB")
        run(RERUN, "rrd", "verify", stream)
        compare(stream, log)
        assert "is there already" in run(tomcom, "review", recording, "--save"), "a whole stream is not made again"
        on_trials_clock(stream)
        whole, lines = stream.read_bytes(), log.read_bytes()
        seal = recording / "recording.rrd.toml"
        middle = len(whole) // 2
        spoils = {
            "the stream was not written to its end": lambda: stream.write_bytes(whole[:-1000]),
            "the stream was damaged or exchanged": lambda: stream.write_bytes(
                whole[:middle] + b"\xff" * 20_000 + whole[middle + 20_000 :]
            ),
            "nothing said which log the stream shows": seal.unlink,
            "the stream did not show the log as the log is now": lambda: seal.write_text(
                seal.read_text().replace("[[logs]]\nbytes = ", "[[logs]]\nbytes = 1")
            ),
        }
        for reason, spoil in spoils.items():
            spoil()
            told = run(tomcom, "review", recording, "--save")
            assert "was made from the log" in told and reason in told, f"{reason}: {told}"
            run(RERUN, "rrd", "verify", stream)
            compare(stream, log)
            assert "is there already" in run(tomcom, "review", recording, "--save"), "it is sealed again"
        log.write_bytes(lines[: len(lines) // 2] + b"\xff" * 100 + lines[len(lines) // 2 + 100 :])
        told = subprocess.run([tomcom, "review", recording, "--save"], capture_output=True, text=True)
        assert told.returncode == 2 and "events.jsonl" in told.stderr, f"a damaged log is told: {told}"
        log.write_bytes(lines)
    same_of_the_same_seed(tomcom, scratch / "again")
    both = scratch / "both.rrd"
    recordings = [next((scratch / session).iterdir()) for session in ("default", "burger")]
    run(tomcom, "review", *recordings, "--save", both)
    run(RERUN, "rrd", "verify", both)
    rows = rows_of(both, "trial_clock_time")
    roots = Counter(entity.split("/")[0] for entity in rows)
    assert len(roots) == 2, roots
    starts = {root: min(place[0] for entity, places in rows.items() if entity.startswith(root) for place in places) for root in roots}
    assert set(starts.values()) == {0}, f"trials begin at the same time: {starts}"
    print("  two recordings side by side, by the clocks of their trials")


if __name__ == "__main__":
    main()
