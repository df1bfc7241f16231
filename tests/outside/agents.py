"""External concepts and participants from Python: the package's runner, and the examples as people would run them.

    tests/outside/agents.py TOMCOM FOLDER
"""

import csv
import dataclasses
import http.server
import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import fastjsonschema

TOMCOM, SCRATCH = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "packaging" / "python"
AGENTS = ROOT / "examples" / "agents"
PYTHON = sys.executable

SESSION = f"""
layout = "{ROOT}/layouts/sushi.toml"
seed = 4711
[trial]
seconds = 60
[robot]
arm = "timed"
"""


def tomcom(*arguments: str | Path, environment: dict[str, str] | None = None, code: int = 0, **options: object) -> str:
    done = subprocess.run(
        [TOMCOM, *map(str, arguments)],
        cwd=SCRATCH,
        env=os.environ | (environment or {}),
        capture_output=True,
        text=True,
        **options,
    )
    assert done.returncode == code, f"{arguments}: {done.stderr}\n{done.stdout}"
    return done.stdout


def events(folder: Path) -> list[dict]:
    lines = (json.loads(line) for log in sorted(folder.glob("*/events.jsonl")) for line in log.open())
    return [line for line in lines if "kind" in line]  # the first line of a log is its header


def simulated(name: str, command: str, trials: int = 2, environment: dict[str, str] | None = None) -> list[dict]:
    """The events of trials in which this concept acts; they verify without the program."""
    out = SCRATCH / name
    arguments = ["simulate", "session.toml", "--condition", "assistant", "--concept", command]
    tomcom(*arguments, "--trials", str(trials), "--out", out, environment=environment)
    for recording in sorted(out.iterdir()):
        assert "verified" in tomcom("replay", recording, "--verify"), recording
    found = events(out)
    wrong = [event for event in found if event.get("what") == "fault"]
    assert not wrong, wrong[:3]
    return found


def check_schema() -> dict:
    """The schema is one, and the classes of the package have its fields."""
    schema = json.loads(tomcom("protocol"))
    fastjsonschema.compile(schema)
    sys.path.insert(0, str(PACKAGE))
    from tomcom import agent  # noqa: PLC0415

    pairs = {
        "kitchen": agent.Kitchen,
        "concept_question": agent.ConceptQuestion,
        "participant_question": agent.ParticipantQuestion,
        "concept_begin": agent.ConceptBegin,
        "participant_begin": agent.ParticipantBegin,
    }
    # What the runner itself reads.
    runner = {"ask", "protocol", "role"}
    for name, kind in pairs.items():
        told = set(schema["$defs"][name]["properties"]) - runner
        known = {field.name for field in dataclasses.fields(kind)}
        assert told - {"id"} <= known <= told, f"{name}: {told ^ known}"
    happenings = schema["$defs"]["happening"]["oneOf"]
    told = {field for one in happenings for field in one["properties"]}
    assert told == {field.name for field in dataclasses.fields(agent.Happening)}
    return schema


def check_messages(schema: dict) -> None:
    """Every line of a trial, both ways, fits the schema."""
    lines = SCRATCH / "lines.jsonl"
    answers = SCRATCH / "answers.jsonl"
    simulated("messages", f"tee {lines} | {PYTHON} {AGENTS}/rule.py | tee {answers}", trials=1)

    def checker(name: str):
        return fastjsonschema.compile({**schema["$defs"][name], "$defs": schema["$defs"]})

    question = fastjsonschema.compile(schema)
    told = [json.loads(line) for line in lines.open()]
    for one in told:
        question(one)
    assert [one["ask"] for one in told[:2]] == ["begin", "signal"] and told[-1]["ask"] == "end"
    said = [json.loads(line) for line in answers.open()]
    checker("begin_answer")(said[0])
    for one in said[1:]:
        checker("concept_answer")(one)
    assert len(said) == len(told) - 1, "one answer for each question"
    print(f"messages: {len(told)} questions and their answers fit the schema")


def check_alone() -> None:
    """An agent needs nothing but Python: no package of another project is there, and none is asked for."""
    blocked = SCRATCH / "blocked"
    blocked.mkdir(exist_ok=True)
    for name in ("pandas", "numpy"):
        (blocked / f"{name}.py").write_text(f"raise ImportError('an agent imports {name}')\n")
    found = simulated("alone", f"PYTHONPATH={blocked}:{PACKAGE} {PYTHON} -S {AGENTS}/rule.py", trials=1)
    assert [event["name"] for event in found if event.get("what") == "began"] == ["after 2 errors"]
    # Whoever reads recordings is told what is missing, and gets everything where it is there.
    for folders, says in ((f"{blocked}:{PACKAGE}", "an agent imports"), (str(PACKAGE), "Recording")):
        done = subprocess.run(
            [PYTHON, "-c", "import tomcom; print(tomcom.Recording)"],
            env=os.environ | {"PYTHONPATH": folders}, capture_output=True, text=True,
        )
        assert says in done.stdout + done.stderr, done
    print("alone: an agent with nothing but Python")


def check_rule() -> None:
    found = simulated("rule", f"{PYTHON} {AGENTS}/rule.py", trials=4)
    reasons = {event.get("words") for event in found if event["kind"] == "advised"} - {None}
    assert reasons == {"2 errors since the last recipe"}, reasons
    signals = [event for event in found if event["kind"] == "signal_shown"]
    assert signals and all("show_recipe" in event["signal"] for event in signals)
    print(f"rule: {len(signals)} recipes shown")


def check_bayes() -> None:
    """pymdp asks for Jupyter and Sphinx, which it does not need: it is installed without them."""
    packages = SCRATCH / "packages"
    install = [PYTHON, "-m", "pip", "install", "--quiet", "--no-deps", "--target", packages, "inferactively-pymdp==0.0.7.1"]
    subprocess.run(install, check=True)
    out = SCRATCH / "bayes-table.csv"
    told = tomcom(
        "tournament", "session.toml", "--concepts", f"tom,{PYTHON} {AGENTS}/bayes.py", "--trials", "6",
        "--out", SCRATCH / "bayes", "--csv", out, "--picture", SCRATCH / "bayes.svg",
        environment={"PYTHONPATH": str(packages)},
    )
    rows = list(csv.DictReader(out.open()))
    assert len(rows) == 2 and "net saving" in told
    (row,) = [row for row in rows if row["name"] == "Bayes (pymdp)"]
    assert row["failed"] == "0" and row["faults"] == "0", row
    assert 0.0 <= float(row["told_auc"]) <= 1.0 and float(row["own_auc"]) > 0.5, row
    assert (SCRATCH / "bayes.svg").read_text().startswith("<svg ")
    print(f"bayes: net saving {row['net_saving_per_100']}, AUC {row['told_auc']} (ours {row['own_auc']})")


def check_chat() -> None:
    """A stub in place of the model: it shows the first signal that the prompt names, and answers nonsense to each fifth prompt."""
    prompts: list[str] = []

    class Stub(http.server.BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            asked = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            prompts.append(asked["messages"][1]["content"])
            signals = prompts[-1].split("Signals that you can send: ")[1].split(". A signal")[0]
            first = signals.split(", ")[0]
            said = json.dumps({"signal": first, "why": f"stub {len(prompts)}"})
            if len(prompts) % 5 == 0:
                said = "As a language model I cannot cook."
            body = json.dumps({"choices": [{"message": {"role": "assistant", "content": f"Sure: {said}"}}]}).encode()
            self.send_response(200)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Stub)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    url = f"http://127.0.0.1:{server.server_port}/v1/chat/completions"
    found = simulated("chat", f"{PYTHON} {AGENTS}/chat.py", trials=1, environment={"CHAT_URL": url, "CHAT_MODEL": "stub"})
    server.shutdown()
    words = [event["words"] for event in found if event["kind"] == "advised"]
    assert len(words) == len(prompts) > 10, (len(words), len(prompts))
    assert sum(one.startswith("stub") for one in words) == len(words) - len(words) // 5
    assert all("Recipes: " in prompt and "order_1: " in prompt for prompt in prompts)
    assert any("the person looked at" in prompt and "pressed" in prompt for prompt in prompts)
    print(f"chat: {len(prompts)} prompts, the model's answers are in the recording")


def check_participant() -> None:
    (SCRATCH / "careless.toml").write_text(
        SESSION + f'[participant]\nkind = "external"\nexternal = "{PYTHON} {AGENTS}/careless.py"\ngaze = "none"\n'
    )
    out = SCRATCH / "careless"
    tomcom("simulate", "careless.toml", "--trials", "2", "--out", out)
    for recording in out.iterdir():
        assert "verified" in tomcom("replay", recording, "--verify"), recording
    presses = [event for event in events(out) if event["kind"] == "press" and event["agent"] == "human"]
    assert len(presses) > 20, len(presses)
    again = SCRATCH / "careless-again"
    tomcom("simulate", "careless.toml", "--trials", "2", "--out", again)
    assert events(again) == events(out), "the same seed, the same presses"
    print(f"participant: {len(presses)} presses")


def check_port() -> None:
    port = 50771
    program = subprocess.Popen([PYTHON, AGENTS / "rule.py", "--port", str(port)])
    try:
        for _ in range(600):
            done = subprocess.run(
                [PYTHON, "-c", f"import socket; socket.create_connection(('127.0.0.1', {port})).close()"],
                capture_output=True,
            )
            if done.returncode == 0:
                break
            time.sleep(0.1)
        found = simulated("port", f"tcp://127.0.0.1:{port}", trials=1)
        assert [event["name"] for event in found if event.get("what") == "began"] == ["after 2 errors"]
    finally:
        program.kill()
        program.wait()
    print("port: a program that listens")


def check_faults() -> None:
    """A program with an error in it: where and what is told."""
    faults = {
        "question.sate": "broken.py:5: AttributeError: ",
        "Advice(values=[1.0])": "broken.py:5: TypeError: values is [1.0]; right would be a dict",
        "Advice(values={'order_1': 1.0})": "broken.py:5: TypeError: a key of values is 'order_1'; right would be one of",
        "Advice(values={Signal('highlight', 'moon'): 1.0})": "ValueError: values has highlight moon, which cannot be sent",
        "Advice(belief={'order_1': {'none': 'x'}})": "broken.py:5: TypeError: belief['order_1']['none'] is 'x'; right",
        "None": "TypeError: what Broken.advise returns is None; right would be an Advice",
    }
    arguments = ["simulate", "session.toml", "--condition", "assistant", "--concept", f"{PYTHON} broken.py"]
    for number, (returned, words) in enumerate(faults.items()):
        (SCRATCH / "broken.py").write_text(
            f"import sys; sys.path.insert(0, {str(PACKAGE)!r})\n"
            "from tomcom.agent import Advice, Concept, Signal, run\n"
            f"class Broken(Concept):\n    def advise(self, question):\n        return {returned}\nrun(Broken())\n"
        )
        told = tomcom(*arguments, "--trials", "2", "--out", SCRATCH / f"broken-{number}", code=1)
        assert "2 trials were aborted" in told and words in told, told
    # The failed trials are kept, which is told.
    told = tomcom(*arguments, "--trials", "2", "--out", SCRATCH / "broken-0", code=1)
    assert "2 trials are of an earlier run; if the program was changed since" in told, told
    print("faults: an error is told with its line")


def figures() -> None:
    """Questions a second over a pipe, and the speed of a cohort with the rule: told, not checked, since machines are busy."""
    echo = SCRATCH / "echo.py"
    echo.write_text(
        "import sys\n"
        "for line in sys.stdin:\n"
        "    at = line.index('\"id\":') + 5\n"
        "    number = line[at:line.index(',', at)] if ',' in line[at:] else '0'\n"
        "    if '\"ask\":\"end\"' in line: break\n"
        "    first = '\"ask\":\"begin\"' in line\n"
        "    print('{\"id\":0,\"protocol\":1,\"name\":\"echo\"}' if first else '{\"id\":' + number + '}', flush=True)\n"
    )
    table = SCRATCH / "echo.csv"
    tomcom("tournament", "session.toml", "--concepts", f"{PYTHON} echo.py", "--trials", "4", "--out", SCRATCH / "echo", "--csv", table)
    (row,) = csv.DictReader(table.open())
    print(f"figures: {float(row['computing_ms']):.3f} ms a question with a trivial program")
    (SCRATCH / "long.toml").write_text(SESSION.replace("seconds = 60", "seconds = 900"))
    began = time.monotonic()
    told = tomcom(
        "simulate", "long.toml", "--condition", "assistant", "--concept", f"{PYTHON} {AGENTS}/rule.py",
        "--trials", "8", "--out", SCRATCH / "cohort", "--format", "json",
    )
    took = time.monotonic() - began
    print(f"figures: 8 trials with the rule at {json.loads(told)['simulated_s'] / took:.0f} times real time")


def main() -> None:
    SCRATCH.mkdir(parents=True, exist_ok=True)
    (SCRATCH / "session.toml").write_text(SESSION)
    schema = check_schema()
    check_messages(schema)
    check_alone()
    check_rule()
    check_bayes()
    check_chat()
    check_participant()
    check_port()
    check_faults()
    figures()


if __name__ == "__main__":
    main()
