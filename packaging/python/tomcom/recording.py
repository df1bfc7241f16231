"""One recording: its log as tables, read when they are asked for."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

try:
    import numpy
    import pandas
except ModuleNotFoundError as missing:
    raise ModuleNotFoundError(f"{missing.name}, by which tomcom reads recordings, is not installed: pip install pandas", name=missing.name) from None

Event = dict[str, Any]

FORMAT = "tomcom-session"
VERSION = 3
# Of every table the columns with their types, in their order.
MOMENT = {"seq": "int64", "t_s": "float64", "trial_s": "float64"}
PRESSES = MOMENT | {"agent": "string", "button": "string", "at_ns": "Int64"}
GAZE = MOMENT | {"x": "float64", "y": "float64", "confidence": "float64", "device_ns": "Int64", "taken_s": "float64"}
SIGNALS = MOMENT | {
    "by": "string", "kind": "string", "about": "string", "offer": "Int64", "ended_s": "float64", "ended": "string",
}
BELIEFS = MOMENT | {
    "source": "string", "press": "Int64", "aspect": "string", "believes": "string", "p_truth": "float64",
    "precision": "float64", "log_p": "float64", "values": "object",
}
PROBES = MOMENT | {
    "probe": "int64", "question": "int64", "asks": "string", "about": "string", "answer": "string",
    "confidence": "Int64", "answered_s": "float64", "on": "string", "skipped": "string", "choices": "object",
}
ORDERS = MOMENT | {"order": "string", "dish": "string", "cleared_s": "float64"}
CLOCK = ("trial_started", "trial_paused", "trial_resumed", "trial_ended", "trial_aborted", "probe")


def read(path: str | os.PathLike[str]) -> Recording:
    """The recording in this folder, or whose `events.jsonl` this is. Reads the header only."""
    return Recording(path)


def recordings(folder: str | os.PathLike[str]) -> list[Recording]:
    """The recordings in a folder, by name; of a recording in parts the last, which contains the others."""
    found = [Recording(log.parent) for log in sorted(Path(folder).glob("*/events.jsonl"))]
    continued = {one.header["continues"]["recording"] for one in found if "continues" in one.header}
    return [one for one in found if one.path.name not in continued]


class Recording:
    """A recorded session. Times are in seconds: `t_s` of the session, `trial_s` of the trial's clock, which stands
    still in pauses and freeze probes, and is missing before the trial."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        path = Path(path)
        self.path: Path = path.parent if path.name == "events.jsonl" else path
        with open(self.path / "events.jsonl", "rb") as log:
            first = log.readline()
        try:
            self.header: Event = json.loads(first)
        except ValueError:
            self.header = {}
        found = (self.header.get("format"), self.header.get("version"))
        if found != (FORMAT, VERSION):
            raise ValueError(f"{self.path / 'events.jsonl'}:1: found {first[:60]!r}; right would be the header of a {FORMAT} of version {VERSION}")

    def __repr__(self) -> str:
        return f"Recording({str(self.path)!r}: {self.participant}, {self.condition})"

    @property
    def participant(self) -> str:
        """The participant's code, as `tomcom correct` left it."""
        corrections = self.path / "correction.toml"
        if corrections.exists():
            return tomllib.loads(corrections.read_text("utf-8"))["correction"][-1]["after"]
        return self.header["session"]["participant"]["code"]

    @property
    def condition(self) -> str:
        """Who sends signals: "none", "wizard" or "assistant"."""
        return self.header["session"]["trial"]["condition"]

    @property
    def excluded(self) -> bool:
        """Whether the trial is left out of the analysis: at the console, by `tomcom exclude`, or as it was aborted."""
        ruling = self.path / "exclusion.toml"
        if ruling.exists():
            return tomllib.loads(ruling.read_text("utf-8"))["excluded"]
        left_out = False
        for event in self.log("trial_excluded", "trial_included", "trial_aborted"):
            left_out = event["kind"] != "trial_included"
        return left_out

    @property
    def settings(self) -> Event:
        """All settings of the session."""
        return self.header["session"]

    def log(self, *kinds: str) -> Iterator[Event]:
        """The events of these kinds as they stand in the log, one after the other; all without `kinds`. The parts of a
        continued recording follow each other."""
        before = self.header.get("continues")
        if before is not None:
            for event in Recording(self.path.parent / before["recording"]).log(*kinds):
                if event["seq"] >= before["events"]:
                    break
                yield event
        wanted = [f'"{kind}"'.encode() for kind in kinds]
        with open(self.path / "events.jsonl", "rb") as lines:
            next(lines)
            for number, line in enumerate(lines, start=2):
                # Samples are most of a log: what is not asked for is not parsed.
                if wanted and not any(kind in line for kind in wanted):
                    continue
                if not line.endswith(b"\n"):
                    return  # a recording that was cut can end in the middle of a line
                try:
                    event = json.loads(line)
                except ValueError as error:
                    raise ValueError(f"{self.path / 'events.jsonl'}:{number}: {error}") from error
                if not kinds or event["kind"] in kinds:
                    yield event

    @cached_property
    def _clock(self) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray]:
        """By numbers of events: from when on the trial's clock has read so many ns at which time, and whether it runs."""
        seqs, pairs, runs = [], [], []
        since, before = 0, 0
        started = paused = probed = over = running = False
        for event in self.log(*CLOCK):
            now, kind = event["t_ns"], event["kind"]
            if kind == "probe" and event["did"] not in ("begun", "ended"):
                continue
            before, since = before + (now - since if running else 0), now
            if kind == "trial_started":
                started = True
            elif kind in ("trial_paused", "trial_resumed"):
                paused = kind == "trial_paused"
            elif kind == "probe":
                probed = event["did"] == "begun"
            else:
                over = True
            running = started and not (paused or probed or over)
            if started:
                seqs.append(event["seq"])
                pairs.append((since, before))
                runs.append(running)
        return numpy.array(seqs, "int64"), numpy.array(pairs, "int64").reshape(-1, 2), numpy.array(runs, bool)

    def _table(self, rows: list[Event], columns: dict[str, str]) -> pandas.DataFrame:
        table = pandas.DataFrame.from_records(rows, columns=[*dict.fromkeys(("t_ns", *columns))])
        at = table.pop("t_ns").astype("int64")
        table["t_s"] = at / 1e9
        seqs, pairs, runs = self._clock
        entry = numpy.searchsorted(seqs, table["seq"].astype("int64"), side="right") - 1
        trial = numpy.full(len(table), numpy.nan)
        there = entry >= 0
        since, before = (pairs[entry[there]].T if there.any() else (0, 0))
        trial[there] = (before + numpy.where(runs[entry[there]], at[there] - since, 0)) / 1e9
        table["trial_s"] = trial
        return table.astype(columns)

    @cached_property
    def events(self) -> pandas.DataFrame:
        """Every event but samples of gaze and arm: a row each, with the fields of the log in columns."""
        kept = [event for event in self.log() if event["kind"] not in ("gaze", "robot_moves")]
        names = dict.fromkeys(name for event in kept for name in event if name != "t_ns")
        columns = MOMENT | {"kind": "string"} | {name: "object" for name in names if name not in ("seq", "kind")}
        return self._table(kept, columns)

    @cached_property
    def presses(self) -> pandas.DataFrame:
        """Presses of participant and robot. `at_ns` is the browser's own time of a press at the display."""
        return self._table(list(self.log("press")), PRESSES)

    @cached_property
    def gaze(self) -> pandas.DataFrame:
        """Samples of gaze: fractions of the display from its top left, from 0 to 1. `taken_s`: when it was taken, in
        session time, where it is known to differ from when it arrived."""
        rows = list(self.log("gaze"))
        for row in rows:
            taken = row.get("taken_ns")
            row["taken_s"] = None if taken is None else taken / 1e9
        return self._table(rows, GAZE)

    @cached_property
    def signals(self) -> pandas.DataFrame:
        """Signals that the participant was shown. `kind`: "show_recipe", "highlight" or "propose"; `ended_s` in session
        time, and why it ended."""
        rows: list[Event] = []
        for event in self.log("signal_shown", "signal_ended"):
            if rows and "ended" not in rows[-1]:
                # The next signal takes the place of the one that stands.
                rows[-1]["ended_s"] = event["t_ns"] / 1e9
                rows[-1]["ended"] = event["reason"] if event["kind"] == "signal_ended" else "replaced"
            if event["kind"] == "signal_shown":
                (kind, about), = event["signal"].items()
                about = about if isinstance(about, str) else ", ".join(about)
                rows.append(event | {"kind": kind, "about": about})
        return self._table(rows, SIGNALS)

    @cached_property
    def beliefs(self) -> pandas.DataFrame:
        """Beliefs about every aspect of the kitchen before a press of the participant, and before a freeze probe. `source`:
        "participant" (of a simulated one, so known) or "estimate" (before presses); `values`: every value with its probability; `log_p`: of the press, under the estimate."""
        rows = [
            {"seq": event["seq"], "t_ns": event["t_ns"], "source": source, "press": event.get("press"), "log_p": event.get("log_p")} | aspect
            for event in self.log("participant_believes", "belief_estimated")
            for source in ["estimate" if event["kind"] == "belief_estimated" else "participant"]
            for aspect in event["aspects"]
        ]
        return self._table(rows, BELIEFS)

    @cached_property
    def probes(self) -> pandas.DataFrame:
        """Questions of freeze probes, with the answers. No answer: the participant does not know; no `answered_s`: not
        answered in time, or `skipped` by the wizard, for that reason."""
        questions: dict[tuple[int, int], Event] = {}
        begun: dict[int, list[Event]] = {}
        for event in self.log("probe"):
            probe, did = event.get("probe", 0), event["did"]
            if did == "begun":
                begun[probe] = event["questions"]
            elif did == "asked":
                number = event["question"]
                about = begun[probe][number - 1]["about"]
                questions[probe, number] = {
                    "seq": event["seq"], "t_ns": event["t_ns"], "probe": probe, "question": number, "asks": about["asks"],
                    "about": about.get("location") or about.get("dish"), "choices": begun[probe][number - 1]["choices"],
                }
            elif did == "answered":
                questions[probe, event["question"]] |= {
                    "answered_s": event["t_ns"] / 1e9, "on": event["on"], "confidence": event.get("confidence"), "answer": event.get("answer"),
                }
            elif did == "skipped":
                open_ones = [row for (of, _), row in questions.items() if of == probe and "answered_s" not in row]
                for row in open_ones:
                    row["skipped"] = event["reason"]
        return self._table(list(questions.values()), PROBES)

    @cached_property
    def orders(self) -> pandas.DataFrame:
        """Orders: when each appeared, its dish, and when it disappeared (in session time)."""
        rows: list[Event] = []
        for event in self.log("order_shown", "order_cleared"):
            if event["kind"] == "order_shown":
                rows.append(event)
            else:
                shown = next(row for row in reversed(rows) if row["order"] == event["order"])
                shown["cleared_s"] = event["t_ns"] / 1e9
        return self._table(rows, ORDERS)
