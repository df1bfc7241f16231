"""Questionnaires on the participant's display: every kind of item, by touch and by keys, over a reload and a kill of the program."""

import csv
import json
import signal
import subprocess
import time
from pathlib import Path

from console import Console
from page import Page

CONSENT = "I have read the information sheet. " * 40
SIZES = [(1280, 720), (1920, 1080), (1080, 1920)]
# Where the buttons are that turn the items.
PLACES = """[...document.querySelectorAll(".turns .next, .turns .skip")].map((made) => {
  const { left, top, width, height } = made.getBoundingClientRect();
  return [made.className, Math.round(left), Math.round(top), Math.round(width), Math.round(height)];
})"""
# Consent by a page that keeps to nothing: it takes the place of the real one, and says at once that the button was held.
FORGED = """(hold) => new Promise((done) => {
  const socket = new WebSocket(`ws://${location.host}/talk`), say = (message) => socket.send(JSON.stringify(message));
  socket.onopen = () => say({ kind: "hello", page: sessionStorage.getItem("page"), width: 800, height: 600, code: null });
  socket.onmessage = ({ data }) => {
    if (JSON.parse(data).kind !== "role") return;
    if (hold) say({ kind: "hold", held: true });
    say({ kind: "consent" });
    setTimeout(() => { socket.close(); done(); }, 4000);
  };
})"""


def session_file(folder, port, language="en"):
    questionnaires, layout = Path("sessions/questionnaires").resolve(), Path("layouts/sushi.toml").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    session = folder / "session.toml"
    asked = "".join(f'[[plan.questionnaire]]\nfile = "{questionnaires}/{name}.toml"\n{when}\n'
                    for name, when in [("demographics", "before = true"), ("nasa-tlx", "after = [1]"), ("sus", "after = [1]")])
    session.write_text(f'layout = "{layout}"\nseed = 3\n[trial]\npresses = 20\n[participant]\nkind = "display"\ngaze = "none"\n'
                       f'[display]\nport = {port}\nlanguage = "{language}"\nquestionnaire = "display"\n'
                       f'[console]\nvisibility = "state"\n[plan]\nname = "asked"\nparticipants = 2\nconditions = ["none", "wizard"]\n'
                       f'consent = "{CONSENT}"\nconsent_on = "display"\n{asked}')
    return session


def events(folder):
    """The events of all recordings, in the order of their folders: a part that continues another one comes behind it."""
    logs = sorted((folder / "recordings").glob("*/events.jsonl"), key=lambda log: log.stat().st_mtime)
    return [json.loads(line) for log in logs for line in log.read_text().splitlines()[1:]]


def given(folder):
    """The last answer to each item."""
    return {event["item"]: event["answer"] for event in events(folder) if event.get("what") == "item_answered"}


def consent_in_tables(tomcom, folder, consent):
    """The tables of the study, and of BIDS, say where the participant consented, when, and to which text."""
    def row(path, dialect):
        (found,) = csv.DictReader(path.open(), dialect=dialect)
        return {name: found[name] for name in ("consent_on", "consent_at", "consent_digest")}

    subprocess.run([tomcom, "study", folder / "recordings", "--out", folder / "study"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([tomcom, "export", folder / "recordings", "--bids", folder / "bids"], check=True, stdout=subprocess.DEVNULL)
    told = row(folder / "study" / "participants.csv", "excel")
    assert told == row(folder / "bids" / "participants.tsv", "excel-tab"), told
    assert (told["consent_on"], told["consent_digest"]) == ("display", consent["digest"]), told
    first = min((folder / "recordings").glob("*/events.jsonl"), key=lambda log: json.loads(log.open().readline())["started"])
    assert told["consent_at"] == json.loads(first.open().readline())["started"], told


def answers_every_kind(tomcom, browser, folder, port, language="en"):
    session = session_file(folder, port, language)
    arguments = [session, "--code", "P01", "--out", folder / "recordings"]
    url = f"http://127.0.0.1:{port}"

    def item(id):
        """The item is shown, and takes touches."""
        page.wait_for(f"Stage.shown() && Stage.shown().question && Stage.shown().question.item === {json.dumps(id)} && !('settles' in document.querySelector('.sheet').dataset)")

    def answer(value):
        written = json.dumps(json.dumps(value, separators=(",", ":")))
        page.wait_for(f"JSON.stringify(Stage.shown().question.answer) === {written}")

    def pictures(name):
        for width, height in SIZES:
            page.page.set_viewport_size({"width": width, "height": height})
            time.sleep(0.3)
            page.screenshot(folder / f"{name}-{width}.png")
        page.page.set_viewport_size({"width": 1920, "height": 1080})
        time.sleep(0.3)

    console = Console(tomcom, arguments)
    with console:
        console.wait_for("Waiting for the participant")
        page = Page(browser, url)
        keyboard, click = page.page.keyboard, page.page.click
        # Only who holds the button all the time agrees.
        item("consent")
        pictures("consent")
        # Keys that do the same are shown.
        sign = lambda made: page.ask(f"getComputedStyle(document.querySelector({json.dumps(made)}), '::after').content").split('"')[1]
        assert (sign(".hold span"), sign(".declines")) == ("↵", page.ask("Stage.scene().words['key delete']"))
        page.page.hover(".hold")
        page.page.mouse.down()
        time.sleep(1.5)
        page.screenshot(folder / "consent-held-1920.png")
        assert page.ask("document.querySelector('.hint.asks').textContent === Stage.scene().words['consent hold']")
        page.page.mouse.up()
        page.wait_for("document.querySelector('.hint.asks').textContent === Stage.scene().words['consent short']")
        time.sleep(2)
        item("consent")
        # A gamepad that is unplugged while its button is down has let go.
        page.page.evaluate("pad.buttons[0].pressed = true")
        time.sleep(1.5)
        page.page.evaluate("navigator.getGamepads = () => []")
        time.sleep(2)
        item("consent")
        # A page that does not wait for the hold is not believed, however long ago it says so.
        for hold in [False, True]:
            page.ask(f"({FORGED})({json.dumps(hold)})")
            console.wait_for("its button was not held long enough")
        # Who does not agree says so, which the console is told; nothing begins.
        # With the focus on "I do not agree", the enter key says so too, however long it is held.
        page.page.focus(".declines")
        keyboard.down("Enter")
        page.wait_for("document.querySelector('.declines').classList.contains('chosen')")
        page.page.wait_for_timeout(3500)
        keyboard.up("Enter")
        item("consent")
        console.wait_for("I do not agree")
        page.page.reload()
        item("consent")
        keyboard.press("Delete")
        page.wait_for("document.querySelector('.declines').classList.contains('chosen')")
        assert page.ask("document.querySelector('.hint.told').textContent === Stage.scene().words.declined")
        assert not list((folder / "recordings").glob("*/")), "recorded without consent"
        keyboard.down("Enter")
        item("age")
        keyboard.up("Enter")
        # A number by touch, beyond its range first, and then by keys.
        item("age")
        places = page.ask(PLACES)
        for key in "16":
            click(f'[data-typed="{key}"]')
        # "Next" is closed, and says why if it is touched.
        click('[data-does="next"]', force=True)
        item("age")
        page.wait_for("document.querySelector('.hint').classList.contains('wrong')")
        click('[data-typed="⌫"]')
        click('[data-typed="⌫"]')
        # Signs that make it another number, or none, are seen and refused: "7,5" is not 75.
        for typed, told in [("7,5", "whole"), ("7.5", "whole"), ("7 5", "whole"), ("+75", "whole"), ("7e1", "whole"), ("-75", "99"), ("750", "99")]:
            keyboard.type(typed)
            keyboard.press("Enter")
            found = page.ask("[document.querySelector('.number output').textContent, document.querySelector('.hint.wrong')?.textContent ?? '']")
            assert found[0] == typed and (told if language == "en" else "99") in found[1], (typed, found)
            item("age")
            if typed == "7,5":
                pictures("number-refused")
            for _ in typed:
                keyboard.press("Backspace")
        # A number that is not complete is neither right nor wrong.
        half = "[document.querySelector('.next').getAttribute('aria-disabled'), document.querySelectorAll('.hint.wrong').length]"
        keyboard.type("1")
        assert page.ask(half) == ["true", 0], page.ask(half)
        click('[data-typed="9"]')
        # "No answer" is chosen like an answer, and takes back nothing that was typed.
        keyboard.press("Delete")
        left = "[document.querySelector('.number output').textContent, document.querySelectorAll('.skip.chosen').length]"
        assert page.ask(left) == ["19", 1], page.ask(left)
        keyboard.press("Backspace")
        keyboard.type("9")
        assert page.ask(left) == ["19", 0], page.ask(left)
        # A digit after it begins a new number.
        keyboard.press("Delete")
        keyboard.type("19")
        assert page.ask(left) == ["19", 0], page.ask(left)
        pictures("number")
        # A second touch of "Next" goes nowhere: neither "No answer" nor another answer is where it was.
        page.page.dblclick('[data-does="next"]')
        item("gender")
        assert page.ask(PLACES) == places, (places, page.ask(PLACES))
        keyboard.press("Shift+Tab")
        page.page.focus("textarea")
        # A text that is too long is not cut, but refused.
        page.page.fill("textarea", "x" * 600)
        keyboard.press("Enter")
        assert "600" in page.ask("document.querySelector('.hint').textContent")
        item("gender")
        pictures("text-refused")
        page.page.fill("textarea", "")
        keyboard.type("0 is a digit, a space")
        pictures("text")
        keyboard.press("Enter")
        item("handedness")
        pictures("choice")
        # What is chosen stays to be seen, however often; "Next" alone goes on.
        page.page.dblclick('[data-option="right"]')
        keyboard.press("1")
        page.page.dblclick('[data-option="left"]')
        page.page.wait_for_timeout(500)
        item("handedness")
        assert page.ask("[...document.querySelectorAll('.options .chosen')].map((made) => made.dataset.option)") == ["left"]
        page.page.dblclick('[data-does="next"]')
        item("vision_aids")
        click('[data-option="lenses"]')
        answer(["lenses"])
        keyboard.press("2")
        answer(["glasses", "lenses"])
        # What excludes the others takes them back, and the other way round.
        click('[data-option="none"]')
        answer(["none"])
        click('[data-option="lenses"]')
        answer(["lenses"])
        # What was taken back wholly is no answer.
        click('[data-option="lenses"]')
        answer([])
        assert page.ask("document.querySelector('.next').getAttribute('aria-disabled')") == "true"
        click('[data-option="lenses"]')
        answer(["lenses"])
        keyboard.press("2")
        answer(["glasses", "lenses"])
        pictures("several")
        # A reload in the middle: what was answered is there.
        page.page.reload()
        item("vision_aids")
        answer(["glasses", "lenses"])
        click('[data-does="next"]')
        item("colour_vision")
        # The program is killed in the middle, and continues where it was.
        console.process.send_signal(signal.SIGKILL)
        console.process.wait()
    page.close()
    console = Console(tomcom, arguments)
    with console:
        console.wait_for("continue this recording")
        page = Page(browser, url)
        keyboard, click = page.page.keyboard, page.page.click
        console.key("1")
        console.key("\r")
        page.stage("questionnaire")
        item("colour_vision")
        keyboard.press("0")
        page.wait_for("document.querySelector('.skip.chosen')")
        keyboard.press("Enter")
        item("cooking")
        assert [sign(made) for made in (".turns .back", ".turns .skip")] == ["←", "0"]
        pictures("scale")
        # What cannot be chosen, and going on without an answer, is told.
        for key, said, more in (("9", "choose", "5"), ("x", "nothing keys", "1 – 5, ←, 0, ↵"), ("Enter", "tutorial first question", "")):
            keyboard.press(key)
            page.wait_for(f"document.querySelector('.why.says')?.textContent === Stage.scene().words['{said}'].replace('#', '{more}')")
        keyboard.press("3")
        keyboard.press("Enter")
        item("robots")
        click('[data-rate="2"]')
        click('[data-does="next"]')
        item("eye_tracking")
        click('[data-does="back"]')
        item("robots")
        answer(2)
        keyboard.press("Enter")
        item("eye_tracking")
        keyboard.press("1")
        keyboard.press("Enter")
        page.wait_for("!Stage.shown().question.item")
        pictures("confirm")
        # No word of an answer is broken.
        broken = page.ask("""[...document.querySelectorAll(".given b:not(.point)")].filter((made) => {
            const range = document.createRange();
            range.selectNodeContents(made);
            return !made.textContent.includes(" ") && range.getClientRects().length > 1;
        }).map((made) => made.textContent)""")
        assert not broken, broken
        # A point of a scale has its number.
        assert page.ask("document.querySelector('[data-review=\"robots\"] .point em').textContent") == "2"
        # Who left an item out sees that; a row goes back to its item, and "Next" from there to all answers.
        assert page.ask("document.querySelector('.given .none').textContent === Stage.scene().words.skip")
        click('[data-review="age"]')
        item("age")
        page.page.wait_for_timeout(400)
        click('[data-does="next"]')
        page.wait_for("!Stage.shown().question.item")
        page.page.wait_for_timeout(400)
        # The enter key presses what has the focus: a row, and "Back".
        for focused in ('[data-review="cooking"]', '[data-does="back"]'):
            page.page.focus(focused)
            keyboard.press("Enter")
            page.wait_for("Stage.shown().question.item")
            item("cooking" if "review" in focused else "eye_tracking")
            click('[data-does="next"]')
            page.wait_for("!Stage.shown().question.item")
            page.page.wait_for_timeout(400)
        keyboard.press("Enter")
        page.stage("answered")
        pictures("thanks")
        time.sleep(1)
        console.key(".")
        page.stage("ready")
        time.sleep(1)
        console.key(".")
        page.stage("running")
        # A trial without a press counts in no analysis; the robot's comes first.
        while not any(event["kind"] == "press" for event in events(folder)):
            time.sleep(0.2)
        console.end()
        page.stage("over")
        time.sleep(1)
        console.key(".")
        page.stage("questionnaire")
        # A slider by touch, and then by arrows and digits.
        item("mental")
        assert [sign(made) for made in (".hint", ".turns .skip", ".turns .next")] == ["← →", page.ask("Stage.scene().words['key delete']"), "↵"]
        pictures("slider")
        box = page.page.locator(".slider").bounding_box()
        page.page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + box["height"] / 2)
        page.page.mouse.down()
        page.page.mouse.move(box["x"] + 0.71 * box["width"], box["y"] + box["height"] / 2, steps=5)
        page.page.mouse.up()
        answer(70)
        keyboard.press("ArrowRight")
        answer(75)
        pictures("slider-answered")
        click('[data-does="next"]')
        item("physical")
        keyboard.press("4")
        answer(40)
        keyboard.press("Enter")
        item("temporal")
        page.close()
        time.sleep(1)
        console.quit()
    found = given(folder)
    assert found == {"age": 19, "gender": "0 is a digit, a space", "handedness": "left", "vision_aids": ["glasses", "lenses"],
                     "cooking": 3, "robots": 2, "eye_tracking": 1, "mental": 75, "physical": 40}, found
    (consent,) = [event for event in events(folder) if event.get("what") == "consent_given"]
    assert consent["on"] == "display" and consent["text"] == CONSENT and len(consent["digest"]) == 16, consent
    consent_in_tables(tomcom, folder, consent)
    skipped = [event["item"] for event in events(folder) if event.get("what") == "item_skipped"]
    assert skipped == ["colour_vision"], skipped
    print("questionnaires: every kind of item by touch and keys, over a reload and a kill", flush=True)
