"""Freeze probes on the participant's display: the real program and a real browser.

    tests/outside/probes_display.py TOMCOM FOLDER

Probes are answered by touch, by keys and by gamepad; the page is loaded again in the middle of one; late answers, presses during a probe, a
pause and a skip change what they should and nothing else; the log has what was answered; and every message to the page is read for
what it must not tell.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

from console import Console
from page import Page, browser, plain

PORT = 20351
# What the page may be told of a probe, and nothing else.
FIELDS = {"probe", "question", "of", "text", "about", "choices", "confidence", "limit_s", "late", "closed"}
NEVER = re.compile(r"inclusion|truth|estimate|origin|correct|right|wrong|believe[sd]|p_truth|variant|due|schedule")


def session_file(folder, kitchen, language, probes):
    folder.mkdir(parents=True, exist_ok=True)
    layout = Path(f"layouts/{kitchen}.toml").resolve()
    path = folder / "session.toml"
    path.write_text(f'layout = "{layout}"\nseed = 5\n[trial]\nseconds = 300.0\npresses = 400\n[participant]\nkind = "display"\ngaze = "none"\n'
                    f'[display]\nport = {PORT}\nlanguage = "{language}"\n[probes]\n{probes}\n')
    return path


class Listened(Page):
    """A page that keeps every message that it is told."""

    def hear(self, payload):
        with self.lock:
            self.__dict__.setdefault("told", []).append(payload)
        super().hear(payload)

    def asks(self, question, seconds=15):
        self.wait_for(f"Stage.shown() && Stage.shown().probe && Stage.shown().probe.question === {question} && Stage.shown().probe.choices.length > 0", seconds)

    def probe(self):
        return self.ask("Stage.shown().probe")


def events(folder):
    (log,) = (folder / "recordings").glob("*/events.jsonl")
    return [json.loads(line) for line in log.read_text().splitlines()[1:]]


def answered(folder):
    return [event for event in events(folder) if event.get("did") == "answered"]


def leaks(page):
    """What the page was told during probes, checked field by field; after each probe the display is as it was before."""
    probes, before, was_probe = 0, None, False
    for payload in page.told:
        message = json.loads(payload)
        sight = message.get("sight")
        if message["kind"] != "sight" or not sight["probe"]:
            assert "left_s" not in message, message
            if sight and sight["stage"] == "running":
                now = [sight["contents"], sight["presses"], sight["signal"], sight["served"]]
                assert not was_probe or now == before, (before, now)
                before, was_probe = now, False
            continue
        was_probe = True
        probes += 1
        probe = sight["probe"]
        assert sight["stage"] == "probe" and sight["contents"] == [] and sight["signal"] is None and sight["intention"] is None, sight
        assert set(message) <= {"kind", "sight", "at", "left_s"} and set(probe) == FIELDS, message
        assert all(set(choice) == {"number", "words", "shows"} for choice in probe["choices"]), probe
        assert not NEVER.search(json.dumps({key: value for key, value in probe.items() if key != "text"})), probe
        shows = [choice["shows"] for choice in probe["choices"]]
        assert len(shows) <= 12 and "empty" not in shows[1:], probe
    return probes


def meant(question, choice):
    """The answer in the log that a choice of the page stands for."""
    return question["choices"][choice["number"] - 1]


def answer(page, way, index=0):
    """Answers the shown question by its choice of this index; None: "I don't know"."""
    probe = page.probe()
    if way == "touch":
        if index is None:
            page.page.locator("[data-unknown]").tap()
            return None
        choice = probe["choices"][index]
        page.page.locator(f'[data-believe="{choice["number"]}"]').tap()
        return choice
    press = page.page.keyboard.press if way == "keys" else lambda name: pad(page, name)
    selector = "[data-unknown]" if index is None else f'[data-believe="{probe["choices"][index]["number"]}"]'
    target = page.ask(f"(() => {{ const {{ left, top, width, height }} = document.querySelector('{selector}').getBoundingClientRect(); return [left + width / 2, top + height / 2]; }})()")
    reach(page, press, target)
    press("Enter")
    return None if index is None else probe["choices"][index]


def reach(page, press, target):
    """Goes by arrows to what lies at this point."""
    where = "(() => { const at = document.querySelector('.at'); if (!at) return null; const { left, top, width, height } = at.getBoundingClientRect(); return [left + width / 2, top + height / 2]; })()"
    for _ in range(40):
        at = page.ask(where)
        if at is None:
            press("ArrowRight")
            continue
        x, y = target[0] - at[0], target[1] - at[1]
        if abs(x) < 3 and abs(y) < 3:
            return
        before = at
        press(("ArrowDown" if y > 0 else "ArrowUp") if abs(y) > 3 else ("ArrowRight" if x > 0 else "ArrowLeft"))
        if page.ask(where) == before:
            press("ArrowRight" if x > 0 else "ArrowLeft")
    raise AssertionError(f"no way to {target}")


def pad(page, name):
    number = {"Enter": 0, "ArrowUp": 12, "ArrowDown": 13, "ArrowLeft": 14, "ArrowRight": 15}[name]
    page.ask(f"pad.buttons[{number}].pressed = true")
    page.page.wait_for_timeout(25)
    page.ask(f"pad.buttons[{number}].pressed = false")
    page.page.wait_for_timeout(25)


def ask_for_probe(console, page):
    """The wizard asks for a probe, and the page blanks the kitchen before the first question."""
    console.key("\x01")
    page.stage("probe")
    assert page.ask("getComputedStyle(document.querySelector('.kitchen')).visibility") == "hidden"
    page.asks(1)


def returns(page):
    """After a count-down of 3 s the trial runs."""
    page.wait_for("Stage.shown().probe && Stage.shown().probe.closed")
    assert 1 <= int(page.ask("document.querySelector('.seconds').textContent")) <= 3
    page.stage("running")


def plays(tomcom, chromium, folder, kitchen, language):
    probes = "per_trial = 0\nafter_signal_s = 0.5\nleast_questions = 3\nmost_questions = 3\nlimit_s = 12.0"
    session = session_file(folder, kitchen, language, probes)
    given = []
    with Console(tomcom, [session, "--code", "P01", "--out", folder / "recordings"]) as console:
        console.wait_for("READY|NO DISPLAY")
        page = Listened(chromium, f"http://127.0.0.1:{PORT}", touch=True)
        page.stage("welcome")
        time.sleep(1)
        console.key(".")
        page.stage("running")

        # By touch, with a reload before the second question is answered: it is the same question, and its time goes on.
        ask_for_probe(console, page)
        given.append(answer(page, "touch", 0))
        page.asks(2)
        question, left = page.probe(), page.ask("document.querySelector('.probing .left').getBoundingClientRect().width")
        page.page.wait_for_timeout(1500)
        page.page.reload()
        page.asks(2)
        assert page.probe() == question, (question, page.probe())
        assert page.ask("document.querySelector('.kitchen') && getComputedStyle(document.querySelector('.kitchen')).visibility") == "hidden"
        # The page knows the program's clock after its first exchange with it.
        page.page.wait_for_function(
            "left => document.querySelector('.probing .left').getBoundingClientRect().width < left - 20", arg=left, timeout=5000
        )
        # A press during a probe is none, whichever way it comes.
        before = len([event for event in events(folder) if event["kind"] == "press" and event["agent"] == "human"])
        page.page.keyboard.press("q")
        page.ask("document.querySelector('[data-button]').dispatchEvent(new PointerEvent('pointerdown', { bubbles: true }))")
        given.append(answer(page, "touch", None))
        page.asks(3)
        given.append(answer(page, "touch", 1))
        page.stage("running")
        assert len([event for event in events(folder) if event["kind"] == "press" and event["agent"] == "human"]) == before

        # By keys. A late answer, to a question that is over or to a probe that is closed, changes nothing.
        page.page.wait_for_timeout(800)
        ask_for_probe(console, page)
        number = page.probe()["probe"]
        # A digit selects the card that shows it, and answers nothing.
        page.page.keyboard.press("2")
        page.wait_for("document.querySelectorAll('.probing .choice')[1].matches('.at[data-key=\"2\"]')")
        page.page.keyboard.press("0")
        page.wait_for("document.querySelector('[data-unknown]').matches('.at')")
        assert page.probe()["question"] == 1
        # The keys stay where they are when the page is drawn anew.
        page.page.keyboard.press("1")
        page.page.keyboard.press("ArrowRight")
        at = "document.querySelector('.probing .at')?.dataset.believe"
        before = page.ask(at)
        page.ask("Stage.resize()")
        assert before and page.ask(at) == before, (before, page.ask(at))
        given.append(answer(page, "keys", 2))
        page.asks(2)
        tell = "kind: 'believe', choice: 1, sure: null"
        said = len(answered(folder))
        page.ask("(() => { const send = WebSocket.prototype.send; WebSocket.prototype.send = function (...all) { window.used = this; return send.apply(this, all); }; })()")
        page.wait_for("window.used")
        late = lambda probe, question: page.ask(f"used.send(JSON.stringify({{ {tell}, probe: {probe}, question: {question} }}))")
        for probe, question in [(number, 1), (number - 1, 2), (number, 3), (number + 1, 1)]:
            late(probe, question)
        page.page.wait_for_timeout(400)
        assert page.probe()["question"] == 2 and len(answered(folder)) == said, "a late answer was taken"
        # A pause by the wizard hides the question; then the same one is shown, and the time has stood still.
        left = page.ask("document.querySelector('.probing .left').getBoundingClientRect().width")
        console.key(".")
        page.stage("paused")
        page.page.wait_for_timeout(2000)
        assert page.ask("Stage.shown().probe") is None
        console.key(".")
        page.asks(2)
        again = page.ask("document.querySelector('.probing .left').getBoundingClientRect().width")
        assert abs(again - left) < 60, f"the time went on in the pause: {left} and {again} px"
        given.append(answer(page, "keys", None))
        # The time of a question goes by: the page says so, and the task goes on.
        page.asks(3)
        page.wait_for("document.querySelector('.probing .left.ends')", 20)
        page.wait_for("Stage.shown().probe.closed && document.querySelector('.probing .late:not(.none, .passes)')", 20)
        returns(page)
        late(number, 3)

        # By gamepad; the wizard skips the rest.
        page.page.wait_for_timeout(800)
        ask_for_probe(console, page)
        given.append(answer(page, "pad", 1))
        page.asks(2)
        console.key("\x1b[3~")
        console.wait_for("Skip the rest of probe")
        console.key("\r")
        console.wait_for(": in words")
        page.page.wait_for_timeout(700)  # a key that is held down counts once
        console.key("\r")
        page.wait_for("Stage.shown().probe && Stage.shown().probe.closed")
        page.stage("running")
        page.page.wait_for_timeout(300)
        console.end()
        page.stage("over")
        looked = leaks(page)
        page.close()
        time.sleep(0.5)
        console.quit()
    check_log(tomcom, folder, given)
    print(f"{kitchen}, {language}: {len(given)} answers by touch, keys and gamepad; {looked} messages during probes tell nothing else", flush=True)


def check_log(tomcom, folder, given):
    """The log has the answers that were given, and only these."""
    log = events(folder)
    asked = {event["probe"]: event["questions"] for event in log if event.get("did") == "begun"}
    found = [(event["probe"], event["question"], event.get("answer")) for event in log if event.get("did") == "answered"]
    assert len(found) == len(given), (found, given)
    for (probe, question, answer), choice in zip(found, given):
        wanted = meant(asked[probe][question - 1], choice) if choice else None
        assert answer == wanted, (probe, question, answer, choice)
    assert all(event["on"] == "display" for event in log if event.get("did") == "answered")
    closed = [event["reason"] for event in log if event.get("did") == "closed"]
    assert closed == ["answered", "time_over", "skipped"], closed
    (recording,) = (folder / "recordings").glob("*")
    verified = subprocess.run([tomcom, "replay", recording, "--verify"], capture_output=True, text=True)
    assert verified.returncode == 0, verified.stdout + verified.stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    with browser() as chromium:
        plays(arguments.tomcom, chromium, arguments.folder / "sushi-en", "sushi", "en")
        plays(arguments.tomcom, chromium, arguments.folder / "burger-de", "burger", "de")


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)
