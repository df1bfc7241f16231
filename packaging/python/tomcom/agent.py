"""Concepts and participants of your own for tomcom, in Python without further packages.

    from tomcom.agent import Concept, Advice, run

    class AfterTwoErrors(Concept):
        def advise(self, question):
            errors = [one for one in question.since if one.what == "press" and one.error]
            ...
            return Advice.silent()

    run(AfterTwoErrors())

Put `concept = { external = "python my_agent.py" }` under `[assistant]` of a session file, or try it with
`tomcom simulate SESSION --condition assistant --concept "python my_agent.py"`. `tomcom protocol` prints the schema.
"""

from __future__ import annotations

import json
import math
import random
import socket
import sys
import traceback
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any, TextIO

PROTOCOL = 1

Belief = Mapping[str, Mapping[str, float]]
"""For some state aspects the probabilities of their values, which sum to 1."""


@dataclass(frozen=True, order=True)
class Signal:
    """A signal to the participant: `Signal("show_recipe", "order_1")` or `Signal("highlight", "cooking_pot")`."""

    kind: str
    target: str | tuple[str, ...]

    @staticmethod
    def read(told: Mapping[str, Any]) -> Signal:
        ((kind, target),) = told.items()
        return Signal(kind, tuple(target) if isinstance(target, list) else target)

    def told(self) -> dict[str, Any]:
        return {self.kind: list(self.target) if isinstance(self.target, tuple) else self.target}

    def __str__(self) -> str:
        return f"{self.kind} {self.target}"


@cache
def _names(kind: type) -> frozenset[str]:
    return frozenset(one.name for one in fields(kind))


def _known(kind: type, told: Mapping[str, Any]) -> dict[str, Any]:
    """Only what the class knows: a later version of the protocol may tell more."""
    names = _names(kind)
    return {name: value for name, value in told.items() if name in names}


@dataclass(frozen=True)
class Location:
    name: str
    kind: str


@dataclass(frozen=True)
class Aspect:
    """What somebody can have a belief about: the content of a location, or the recipe of a dish (its first value is true)."""

    name: str
    values: list[str]


@dataclass(frozen=True)
class Button:
    name: str
    does: str
    with_: str | None = None


@dataclass(frozen=True)
class Dish:
    name: str
    items: list[str]


@dataclass(frozen=True)
class Step:
    name: str
    place: str | None
    by: list[str]
    makes: dict[str, str]


@dataclass(frozen=True)
class Kitchen:
    name: str
    locations: list[Location]
    aspects: list[Aspect]
    human_buttons: list[Button]
    robot_buttons: list[Button]
    dishes: list[Dish]
    steps: list[Step]

    @staticmethod
    def read(told: Mapping[str, Any]) -> Kitchen:
        def button(one: Mapping[str, Any]) -> Button:
            return Button(one["name"], one["does"], one.get("with"))

        return Kitchen(
            told["name"],
            [Location(**_known(Location, one)) for one in told["locations"]],
            [Aspect(**_known(Aspect, one)) for one in told["aspects"]],
            [button(one) for one in told["human_buttons"]],
            [button(one) for one in told["robot_buttons"]],
            [Dish(**_known(Dish, one)) for one in told["dishes"]],
            [Step(**_known(Step, one)) for one in told["steps"]],
        )

    def aspect(self, name: str) -> Aspect:
        return next(aspect for aspect in self.aspects if aspect.name == name)


@dataclass(frozen=True)
class Happening:
    """What happened since the last question. `what` is look, press, order, order_cleared, signal, signal_ended or human_waits;
    the other fields are those of the schema, None where they do not apply."""

    at_s: float
    what: str
    location: str | None = None
    for_s: float | None = None
    by: str | None = None
    button: str | None = None
    effective: bool | None = None
    error: bool | None = None
    order: str | None = None
    dish: str | None = None
    signal: Signal | None = None
    silent_s: float | None = None

    @staticmethod
    def read(told: Mapping[str, Any]) -> Happening:
        known = _known(Happening, told)
        if "signal" in known:
            known["signal"] = Signal.read(known["signal"])
        return Happening(**known)


@dataclass(frozen=True)
class Robot:
    still: bool
    button: str | None = None
    in_s: float | None = None


@dataclass(frozen=True)
class ConceptBegin:
    """The first question to a concept."""

    seed: int
    cost_of_communication: float
    signal_shown_s: float
    kitchen: Kitchen


@dataclass(frozen=True)
class ConceptQuestion:
    """A question to a concept; `state` has the true value of every aspect."""

    id: int
    time_s: float
    presses: int
    state: dict[str, str]
    robot: Robot
    since: list[Happening]
    signals: list[Signal]
    estimate: dict[str, dict[str, float]] | None = None

    @staticmethod
    def read(told: Mapping[str, Any]) -> ConceptQuestion:
        known = _known(ConceptQuestion, told)
        known["robot"] = Robot(**_known(Robot, told["robot"]))
        known["since"] = [Happening.read(one) for one in told["since"]]
        known["signals"] = [Signal.read(one) for one in told["signals"]]
        return ConceptQuestion(**known)

    def about(self, name: str) -> Signal | None:
        """The signal about this order or location, if it can be sent now."""
        return next((signal for signal in self.signals if signal.target == name), None)


@dataclass(frozen=True)
class ParticipantBegin:
    """The first question to a participant: the constant part of its display."""

    seed: int
    scene: dict[str, Any]


@dataclass(frozen=True)
class ParticipantQuestion:
    """A question to a participant: what its display shows now."""

    id: int
    time_s: float
    display: dict[str, Any]


# What an answer has is checked where it is made, so that an error names the agent's own line.


def _wrong(field: str, found: object, right: str) -> TypeError:
    return TypeError(f"{field} is {found!r}; right would be {right}")


def _check(field: str, found: object, kind: type, right: str) -> None:
    if not isinstance(found, kind):
        raise _wrong(field, found, right)


def _number(field: str, found: Any) -> float:
    """Also of another package's number."""
    try:
        number = math.nan if isinstance(found, str) else float(found)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise _wrong(field, found, "a number")
    return number


def _belief(belief: Belief) -> dict[str, dict[str, float]]:
    _check("belief", belief, Mapping, "a dict from aspects to the probabilities of their values")
    for aspect, values in belief.items():
        _check(f"belief[{aspect!r}]", values, Mapping, "a dict from values to probabilities")
    return {
        aspect: {value: _number(f"belief[{aspect!r}][{value!r}]", p) for value, p in values.items()}
        for aspect, values in belief.items()
    }


@dataclass(frozen=True)
class Advice:
    """What a concept answers: values for signals, or a signal to send, or neither."""

    values: Mapping[Signal, float] | None = None
    send: Signal | None = None
    reason: str | None = None
    belief: Belief | None = None

    def __post_init__(self) -> None:
        if self.values is not None:
            _check("values", self.values, Mapping, "a dict from signals to the presses that they save")
            for signal, value in self.values.items():
                _check("a key of values", signal, Signal, "one of question.signals")
                _number(f"values[{signal}]", value)
        if self.send is not None:
            _check("send", self.send, Signal, "one of question.signals")
        if self.reason is not None:
            _check("reason", self.reason, str, "a text")
        if self.belief is not None:
            _belief(self.belief)

    @staticmethod
    def silent(reason: str | None = None, belief: Belief | None = None) -> Advice:
        return Advice(None, None, reason, belief)

    def answer(self, question: ConceptQuestion) -> dict[str, Any]:
        answer: dict[str, Any] = {"id": question.id}
        if self.values is not None:
            if unknown := set(self.values) - set(question.signals):
                can_be_sent = ", ".join(map(str, question.signals))
                raise ValueError(f"values has {min(unknown, key=str)}, which cannot be sent now; right would be: {can_be_sent}")
            # What has no value is not worth sending.
            answer["values"] = [float(self.values.get(signal, -1e6)) for signal in question.signals]
        if self.send is not None:
            answer["send"] = self.send.told()
        if self.reason is not None:
            answer["reason"] = self.reason
        if self.belief is not None:
            answer["belief"] = _belief(self.belief)
        return answer


@dataclass(frozen=True)
class Move:
    """What a participant answers: a press, in so many seconds; or nothing, to wait for the next change of its display."""

    press: str | None = None
    after_s: float | None = None
    belief: Belief | None = None

    def __post_init__(self) -> None:
        if self.press is not None:
            _check("press", self.press, str, "the name of a button")
        if self.after_s is not None:
            _number("after_s", self.after_s)
        if self.belief is not None:
            _belief(self.belief)

    def answer(self, question: ParticipantQuestion) -> dict[str, Any]:
        answer: dict[str, Any] = {"id": question.id, "press": self.press}
        if self.after_s is not None:
            answer["after_s"] = float(self.after_s)
        if self.belief is not None:
            answer["belief"] = _belief(self.belief)
        return answer


class Concept:
    """A communication concept: `begin` is called once, `advise` at every question."""

    name: str = ""
    random: random.Random
    """Random numbers of the trial: the same trial gives the same ones."""

    def begin(self, told: ConceptBegin) -> None:
        """Takes the kitchen and the settings of a trial."""

    def advise(self, question: ConceptQuestion) -> Advice:
        raise NotImplementedError


class Participant:
    """A participant: `begin` is called once, `act` at every question."""

    name: str = ""
    random: random.Random
    """Random numbers of the trial: the same trial gives the same ones."""

    def begin(self, told: ParticipantBegin) -> None:
        """Takes the constant part of the display."""

    def act(self, question: ParticipantQuestion) -> Move:
        raise NotImplementedError


def _answer(mind: Concept | Participant, told: Mapping[str, Any]) -> dict[str, Any]:
    if told["ask"] == "begin":
        if told["protocol"] != PROTOCOL:
            raise ValueError(f"protocol {told['protocol']}; this package speaks {PROTOCOL}")
        # The same trial gives the same random numbers.
        mind.random = random.Random(told["seed"])
        if isinstance(mind, Concept):
            begin = _known(ConceptBegin, told) | {"kitchen": Kitchen.read(told["kitchen"])}
            mind.begin(ConceptBegin(**begin))
        else:
            mind.begin(ParticipantBegin(**_known(ParticipantBegin, told)))
        return {"id": told["id"], "protocol": PROTOCOL, "name": mind.name or type(mind).__name__}
    if isinstance(mind, Concept):
        question = ConceptQuestion.read(told)
        advice = mind.advise(question)
        _check(f"what {type(mind).__name__}.advise returns", advice, Advice, "an Advice")
        return advice.answer(question)
    seen = ParticipantQuestion(**_known(ParticipantQuestion, told))
    move = mind.act(seen)
    _check(f"what {type(mind).__name__}.act returns", move, Move, "a Move")
    return move.answer(seen)


def answers(mind: Concept | Participant, lines: Iterable[str]) -> Iterable[str]:
    """The answers to lines with questions, as lines."""
    for line in lines:
        told = json.loads(line)
        if told["ask"] == "end":
            return
        yield json.dumps(_answer(mind, told), allow_nan=False, separators=(",", ":"))


def run(mind: Concept | Participant) -> None:
    """Answers until the trial is over: over standard input and output or, with `--port N`, to whoever connects there."""
    if "--port" in sys.argv:
        port = int(sys.argv[sys.argv.index("--port") + 1])
        with socket.create_server(("127.0.0.1", port)) as server:
            while True:
                connection, _ = server.accept()
                with connection, connection.makefile("rw", encoding="utf-8", newline="\n") as lines:
                    _serve(mind, lines, lines)
    # What an agent prints must not come between its answers.
    out, sys.stdout = sys.stdout, sys.stderr
    _serve(mind, sys.stdin, out)


def _serve(mind: Concept | Participant, questions: TextIO, out: TextIO) -> None:
    try:
        for answer in answers(mind, questions):
            out.write(answer + "\n")
            out.flush()
    except Exception as error:
        traceback.print_exc()
        # The last line is what tomcom tells: it says where, if not in this file and the methods that dataclasses make.
        frames = reversed(traceback.extract_tb(error.__traceback__))
        place = next((one for one in frames if one.filename not in (__file__, "<string>")), None)
        where = f"{Path(place.filename).name}:{place.lineno}: " if place else ""
        sys.exit(f"{where}{type(error).__name__}: {error}")
