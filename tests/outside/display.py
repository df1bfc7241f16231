"""Whole orders on the participant's display: the real program, a real browser, hands that a test moves.

    tests/outside/display.py TOMCOM FOLDER
"""

import json
import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import questions
import tags
from console import Console, parser
from page import Page, browser, plain

PORT = 20331
SIZE = (1280, 800)
# Sessions whose first order a person can serve alone: the seed, and the presses for each such dish.
BASES = {
    "maki": ["take rice", "cooking_pot", "cook", "cooking_pot", "assembly_board", "take nori", "assembly_board"],
    "nigiri": ["take rice", "cooking_pot", "cook", "cooking_pot", "shape", "assembly_board", "take nori", "assembly_board"],
}
CUT = ["cutting_board", "cut", "cutting_board", "assembly_board"]
TOPPINGS = {
    "salmon": ["take salmon", *CUT],
    "shrimp": ["take shrimp", "cooking_pot", "cook", "cooking_pot", *CUT],
    "crab": ["take crab", "cooking_pot", "cook", "cooking_pot", *CUT],
}
BURGER = ["take light bun", "board", "take cheese", "board", "take soy", "grill_plate", "grill", "grill_plate", "board",
          "take pepper", "slice", "board", "board", "tray", "serve 1"]


def presses_for(kitchen, dish, order):
    if kitchen == "burger":
        assert dish == "garden burger", dish
        return BURGER
    topping, base = dish.split()
    return [*BASES[base], *TOPPINGS[topping], "assembly_board", "plate", f"serve {order}"]


def session_file(folder, kitchen, seed, shadow="off", presses=304):
    folder.mkdir(parents=True, exist_ok=True)
    layout = Path(f"layouts/{kitchen}.toml").resolve()
    path = folder / "session.toml"
    path.write_text(f'layout = "{layout}"\nseed = {seed}\n[trial]\npresses = {presses}\n[participant]\nkind = "display"\ngaze = "mouse"\n'
                    f'[display]\nport = {PORT}\nserved = true\nclock = true\nsound = true\n[signals]\ncool_down_s = 0.0\n[assistant]\nshadow = "{shadow}"\n')
    return path


def url():
    return f"http://127.0.0.1:{PORT}"


def operate(tomcom, session, folder, *more):
    console = Console(tomcom, [session, "--out", folder / "recordings", *more])
    console.wait_for("READY|NO DISPLAY")
    return console


def start(console, page, robot_held=True):
    """Starts the trial; where the robot is held, the person works alone."""
    page.stage("welcome")
    page.page.mouse.move(960, 500)
    if robot_held:
        console.key("\x10")
        console.wait_for("ROBOT HELD")
    time.sleep(1.5)
    console.key(".")
    if robot_held:
        console.wait_for("Checks before the trial")
        console.key("o")
    page.stage("running")
    page.wait_for("Stage.shown().contents.some((what) => what.dish)")


def verified(tomcom, folder):
    """The events of the folder's only recording, which verifies."""
    (recording,) = (folder / "recordings").iterdir()
    subprocess.run([tomcom, "replay", recording, "--verify"], check=True, stdout=subprocess.DEVNULL)
    return [json.loads(line) for line in (recording / "events.jsonl").read_text().splitlines()[1:]]


def seed_of(tomcom, folder, kitchen):
    """A seed whose first order a person can serve alone."""
    for seed in range(1, 60):
        session = session_file(folder / "seed", kitchen, seed)
        text = session.read_text().replace('kind = "display"\ngaze = "mouse"', 'kind = "simulated"')
        session.write_text(text.replace("[trial]\n", "[trial]\nseconds = 1.0\n"))
        out = folder / "seed" / str(seed)
        subprocess.run([tomcom, "simulate", session, "--trials", "1", "--out", out], check=True, stdout=subprocess.DEVNULL)
        (recording,) = out.iterdir()
        shown = [json.loads(line) for line in (recording / "events.jsonl").read_text().splitlines()[1:]]
        first = next(event["dish"] for event in shown if event["kind"] == "order_shown")
        if first == "garden burger" or kitchen == "sushi" and "tuna" not in first:
            return seed
    raise AssertionError("no such seed")


def plays_an_order(tomcom, browser, folder, kitchen, seed, way):
    console = operate(tomcom, session_file(folder, kitchen, seed), folder)
    with console:
        page = Page(browser, url(), touch=way == "touch")
        start(console, page)
        presses = presses_for(kitchen, page.orders()[0], 1)
        for button in presses:
            page.press(button, way)
        page.wait_for("Stage.shown().served === 1")
        assert page.ask("document.querySelector('.spot.order').dataset.holds") == "served"
        page.close()
        console.wait_for("NO DISPLAY")
        console.quit()
    events = verified(tomcom, folder)
    told = [event for event in events if event["kind"] == "press" and event["agent"] == "human"]
    assert [event["button"] for event in told] == presses, told
    late_ms = [(event["t_ns"] - event["at_ns"]) / 1e6 for event in told]
    assert all(late >= 0 for late in late_ms), late_ms
    kinds = [event.get("what") for event in events if event["kind"] == "display"]
    assert kinds[0] == "connected" and "drawn" in kinds and kinds[-1] == "lost", kinds
    print(f"{kitchen} by {way}: an order served with {len(presses)} presses, stamped at most {max(late_ms):.1f} ms after "
          "they happened; the recording verifies", flush=True)


def shows_signals(tomcom, browser, folder, seed):
    console = operate(tomcom, session_file(folder, "sushi", seed), folder)
    with console:
        page = Page(browser, url())
        start(console, page)
        is_open = "document.querySelector('.recipe').classList.contains('open')"
        assert not page.ask(is_open)
        page.page.keyboard.press("y")
        page.page.keyboard.press("y")
        console.key("q")
        page.wait_for(is_open)
        words = plain(page.ask("document.querySelector('.recipe').innerText"))
        dish = page.orders()[0]
        assert dish in words and "nori" in words and "rice" in words, words
        page.page.wait_for_timeout(500)
        page.screenshot(folder / "recipe-1920.png")
        console.key("a")
        page.wait_for("document.querySelector('.highlight .name')?.textContent === 'assembly board'")
        assert not page.ask(is_open)
        page.screenshot(folder / "highlight-1920.png")
        console.key("\x7f")
        page.wait_for("!document.querySelector('.highlight')")
        # A second page only watches.
        other = Page(browser, url(), size=(1280, 720))
        other.stage("running")
        other.wait_for("document.querySelector('.toast').textContent.includes('only watches')")
        before = page.presses()
        other.page.keyboard.press("u")
        other.page.wait_for_timeout(300)
        assert page.presses() == before
        other.close()
        page.page.set_viewport_size({"width": 1280, "height": 720})
        page.page.wait_for_timeout(400)
        page.screenshot(folder / "running-1280.png")
        for script in ["scrollHeight <= innerHeight", "scrollWidth <= innerWidth"]:
            assert page.ask(f"document.documentElement.{script.replace('inner', 'window.inner')}"), script
        page.close()
        console.quit()
    events = verified(tomcom, folder)
    drawn = [event["cue"] for event in events if event["kind"] == "display" and event["what"] == "drawn"]
    cues = [event["seq"] for event in events if event["kind"] in ("trial_started", "signal_shown", "trial_ended")]
    assert drawn == cues, (drawn, cues)
    print("signals: recipe and highlight appear, are taken back, are told to be drawn; a second page only watches", flush=True)


def shows_the_robot(tomcom, browser, folder, seed, shown):
    """The robot's hand is at each of its presses as the page shows it; every message of the robot is a pose and nothing else."""
    session = session_file(folder, "sushi", seed)
    session.write_text(session.read_text().replace("[display]\n", f'[display]\narm = "{shown}"\n'))
    console = operate(tomcom, session, folder)
    with console:
        page = Page(browser, url())
        start(console, page, robot_held=False)
        away = []
        for number in range(1, 5):
            page.wait_for(f"Stage.shown().presses[1] && Stage.shown().presses[1].number >= {number}")
            away.append(page.ask("""() => {
                const { at } = Stage.shown().presses[1], scene = Stage.scene(), hand = document.querySelector(".robot-hand");
                const [x, y, w, h] = ("storage" in at ? scene.storages[at.storage] : scene.locations[at.location]).area;
                return hand && Math.hypot(hand.dataset.x - x - w / 2, hand.dataset.y - y - h / 2);
            }"""))
            if number == 2:
                page.page.wait_for_timeout(1200)
                page.screenshot(folder / f"robot-{shown}-1920.png")
        drawn = page.ask("['.robot-hand', '.robot-arm', '.robot-arm.links'].map((name) => document.querySelectorAll(name).length)")
        # What the hand holds is drawn once: in the hand, or at its place where there is no hand.
        assert page.ask("document.querySelectorAll('.spot.robot_hand .content svg').length") == 0 or shown == "none"
        # A stop is said, and seen at a glance; then the robot goes on.
        console.key(" ")
        page.wait_for("document.getElementById('stage').dataset.robot === 'stopped'")
        assert page.ask("document.querySelector('.zone.robot h2').textContent") == "Robot stopped"
        page.screenshot(folder / f"robot-{shown}-stopped.png")
        console.key("\x12")
        page.wait_for("document.querySelector('.zone.robot h2').textContent === 'The robot moves again.'")
        page.close()
        console.quit()
    told = [message["robot"] for message in page.robot]
    if shown == "none":
        assert not told and away == [None] * 4, (told[:2], away)
    else:
        assert len(told) > 40 and all(set(message) == {"kind", "robot"} for message in page.robot), page.robot[:2]
        assert all(set(pose) == {"x", "y", "down"} for pose in told), told[:2]
        # The page asks a moment after the press, when the hand may have set out again.
        assert max(away) < 0.12, away
    assert drawn == {"none": [0, 0, 0], "hand": [1, 1, 0], "arm": [1, 1, 1]}[shown], drawn
    verified(tomcom, folder)
    print(f"the robot shown as {shown}: {len(told)} messages, each a pose; at its presses the hand is {max(a or 0 for a in away):.3f} of the "
          "display away at most", flush=True)


def comes_back(tomcom, browser, folder, seed):
    """The server is killed in the middle and started again: the page comes back by itself, with the whole state."""
    console = operate(tomcom, session_file(folder, "sushi", seed), folder)
    with console:
        page = Page(browser, url())
        start(console, page)
        page.press("take rice", "keyboard")
        page.press("cooking_pot", "keyboard")
        before = page.ask("JSON.stringify(Stage.shown().contents)")
        page.page.evaluate("document.body.dataset.same = 'page'")
        console.process.kill()
        console.process.wait()
        page.wait_for("document.getElementById('stage').classList.contains('lost')")
    (recording,) = (folder / "recordings").iterdir()
    console = Console(tomcom, ["--continue", recording])
    with console:
        page.stage("paused")
        assert page.ask("document.body.dataset.same") == "page", "the page was loaded again"
        assert page.ask("JSON.stringify(Stage.shown().contents)") == before
        console.wait_for("PAUSED")
        console.key(".")
        page.stage("running")
        page.press("cook", "keyboard")
        page.close()
        console.quit()
    print("the program killed and started again: the page comes back by itself with the whole state", flush=True)


class Stall:
    """Between page and program: passes everything on until it stalls, as a network that is gone without a word."""

    def __init__(self, port):
        self.port, self.stalled, self.server = port, threading.Event(), socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self.server.getsockname()[1]}"
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            near, _ = self.server.accept()
            if self.stalled.is_set():
                continue
            far = socket.create_connection(("127.0.0.1", self.port))
            for one, other in ((near, far), (far, near)):
                threading.Thread(target=self.pass_on, args=(one, other), daemon=True).start()

    def pass_on(self, one, other):
        try:
            while data := one.recv(65536):
                if not self.stalled.is_set():
                    other.sendall(data)
            other.shutdown(socket.SHUT_WR)
        except OSError:
            pass


def tells_a_dead_connection(tomcom, browser, folder, seed, how):
    """A connection that stalls without being closed, or a browser that is offline: the page says so, the trial is paused by itself, and both come back."""
    session = session_file(folder, "sushi", seed)
    session.write_text(session.read_text().replace("[display]\n", "[display]\npause_when_lost = true\n"))
    console = operate(tomcom, session, folder)
    with console:
        between = Stall(PORT)
        page = Page(browser, between.url)
        def cut(is_cut):
            if how == "offline":
                page.context.set_offline(is_cut)
            elif is_cut:
                between.stalled.set()
            else:
                between.stalled.clear()
        start(console, page)
        page.press("take rice", "keyboard")
        began = time.monotonic()
        cut(True)
        page.wait_for("document.querySelector('.toast.says-lost')")
        told_s, words = time.monotonic() - began, plain(page.ask("document.querySelector('.toast').innerText"))
        assert words.startswith("Connection lost"), words
        page.page.keyboard.press("x")
        page.wait_for("document.querySelector('.toast.refuses')")
        console.wait_for("PAUSED")
        paused_s = time.monotonic() - began
        cut(False)
        page.stage("paused")
        assert page.ask("document.querySelector('.card p').textContent === Stage.scene().words['paused lost text']"), "a pause without its reason"
        console.key(".")
        page.stage("running")
        page.press("cooking_pot", "keyboard")
        page.close()
        console.quit()
    events = verified(tomcom, folder)
    kinds = [event.get("what", event["kind"]) for event in events if event["kind"] in ("display", "trial_paused", "trial_resumed")]
    kinds = [kind for kind in kinds if kind != "drawn"]
    # What a browser kept while it was offline comes before its page connects anew.
    resumed = kinds.index("trial_resumed")
    assert kinds[:3] == ["connected", "lost", "trial_paused"] and kinds[resumed - 1] == "connected", kinds
    assert [event["button"] for event in events if event["kind"] == "press" and event["agent"] == "human"] == ["take rice", "cooking_pot"]
    print(f"a connection that is cut ({how}): told after {told_s:.1f} s, paused after {paused_s:.1f} s; the press meanwhile is refused aloud", flush=True)


def asks_for_a_code(tomcom, browser, folder, seed):
    console = operate(tomcom, session_file(folder, "sushi", seed), folder, "--listen", "0.0.0.0")
    with console:
        console.key("\x06")
        console.wait_for(r"pairing code [A-Z0-9]{6}")
        code = plain(console.text()).split("pairing code ")[1][:6]
        page = Page(browser, url())
        page.wait_for("document.querySelector('input')")
        assert not page.ask("document.querySelector('.spot')")
        page.page.fill("input", "WRONG1")
        page.page.keyboard.press("Enter")
        page.wait_for("document.querySelector('.wrong')")
        page.page.fill("input", code.lower())
        page.page.keyboard.press("Enter")
        page.stage("welcome")
        page.close()
        # The list of what was looked at, with the code in it, is closed.
        console.key("\x1b")
        time.sleep(0.3)
        console.quit()
    print("served to the network it asks for the pairing code, and takes no other", flush=True)


def has_phases(tomcom, browser, folder):
    """A plan's questionnaire is answered on the display, in German."""
    text = Path("sessions/study.toml").read_text()
    layout, questionnaires = Path("layouts/sushi.toml").resolve(), Path("sessions/questionnaires").resolve()
    text = text.replace("../layouts/sushi.toml", str(layout)).replace('"questionnaires/', f'"{questionnaires}/')
    # tests/outside/tutorial.py plays the tutorial.
    text = "".join(line for line in text.splitlines(True) if not line.startswith("tutorial ="))
    text = text[: text.index("[plan.familiarisation]")] + text[text.index("[[plan.questionnaire]]"):]
    folder.mkdir(parents=True, exist_ok=True)
    session = folder / "session.toml"
    session.write_text(text.replace("[display]\n", f'[display]\nport = {PORT}\nlanguage = "de"\nquestionnaire = "display"\n'))
    console = Console(tomcom, [session, "--code", "P01", "--out", folder / "recordings"])
    with console:
        console.wait_for("agrees")
        page = Page(browser, url())
        # A page that stayed open has thanked somebody else.
        page.stage("welcome")
        console.key("1")
        console.key("\r")
        page.stage("instruction")
        page.screenshot(folder / "instruction-1920.png")
        for _ in range(12):
            time.sleep(0.9)
            console.key("\r")
            if page.ask("document.getElementById('stage').dataset.stage") == "ready":
                break
        page.stage("ready")
        assert "Machen Sie sich bereit" in page.ask("document.querySelector('.sheet').innerText")
        console.key(".")
        page.stage("running")
        console.end()
        page.stage("over")
        time.sleep(1)
        console.key(".")
        page.stage("questionnaire")
        page.wait_for("Stage.shown().question")
        page.screenshot(folder / "question-1920.png")
        count = page.ask("Stage.shown().question.of")
        for number in range(count):
            page.wait_for(f"!Stage.shown().question.item || Stage.shown().question.number === {number + 1}")
            page.page.wait_for_timeout(400)  # a touch so soon after the last one is its double
            page.page.keyboard.press("6") if number % 2 else page.page.click('[data-rate="4"]')
            page.page.keyboard.press("Enter") if number % 2 else page.page.click('[data-does="next"]')
        page.wait_for("!Stage.shown().question.item")
        page.page.wait_for_timeout(400)
        page.page.click('[data-does="confirm"]')
        page.wait_for("!Stage.shown().question")
        page.close()
        console.quit()
    events = verified(tomcom, folder)
    answers = [event["answer"] for event in events if event.get("what") == "item_answered"]
    assert answers == [6 if number % 2 else 4 for number in range(count)], answers
    print(f"phases of a plan in German; {count} items answered on the display by keys and touch", flush=True)


def main():
    arguments = parser(__doc__).parse_args()
    tomcom, folder = arguments.tomcom, arguments.folder
    with browser() as chromium:
        seeds = {kitchen: seed_of(tomcom, folder / kitchen, kitchen) for kitchen in ("sushi", "burger")}
        for kitchen, seed in seeds.items():
            for way in ("keyboard", "touch", "gamepad"):
                plays_an_order(tomcom, chromium, folder / kitchen / way, kitchen, seed, way)
        shows_signals(tomcom, chromium, folder / "signals", seeds["sushi"])
        for shown in ("hand", "arm", "none"):
            shows_the_robot(tomcom, chromium, folder / f"robot-{shown}", seeds["sushi"], shown)
        comes_back(tomcom, chromium, folder / "restart", seeds["sushi"])
        for how in ("stalled", "offline"):
            tells_a_dead_connection(tomcom, chromium, folder / how, seeds["sushi"], how)
        asks_for_a_code(tomcom, chromium, folder / "code", seeds["sushi"])
        has_phases(tomcom, chromium, folder / "phases")
        questions.answers_every_kind(tomcom, chromium, folder / "questions", PORT)
    for name in ("recipe-1920.png", "highlight-1920.png", "running-1280.png"):
        tags.check(str(folder / "signals" / name))
        tags.check_corners(tomcom, "layouts/sushi.toml", str(folder / "signals" / name))


if __name__ == "__main__":
    main()
    # All is checked. Libraries in C may crash while the interpreter is taken down, which says nothing of the program.
    sys.stdout.flush()
    os._exit(0)
