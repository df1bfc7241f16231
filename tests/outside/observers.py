"""Observers of the wizard's screen: Chromium's text of the page against what tmux has on its screen, twenty observers and one more,
and one who reads nothing.

    tests/outside/observers.py TOMCOM FOLDER
"""

import json
import socket
import sys
import time
from contextlib import ExitStack
from pathlib import Path

from console import Tmux, percentile, recorded, verify
from page import browser
from websockets.sync.client import connect

PORT = 20371
URL = f"http://127.0.0.1:{PORT}"
# Asked for on an idle machine, from a change in the terminal to the same text on the page.
LIMIT_MS = 300
LIST = "Checks before the trial"
TEXT = "[...document.querySelectorAll('#screen .line')].map((line) => line.textContent.trimEnd()).join('\\n').trimEnd()"
# Notes when the page has a text: a page that is asked again and again by a script is slowed down by it.
WATCH = f"""
window.seen = [];
const note = () => {{ const text = {TEXT}; if (!seen.length || seen[seen.length - 1].text !== text) seen.push({{ text, at: Date.now() }}); }};
addEventListener("DOMContentLoaded", () => new MutationObserver(note).observe(document.getElementById("screen"), {{ childList: true, subtree: true }}));
"""


def open_page(chromium, observer):
    page = chromium.new_context(bypass_csp=True, viewport={"width": 1400, "height": 900}).new_page()
    page.errors = []
    page.on("pageerror", lambda error: page.errors.append(str(error)))
    page.add_init_script(WATCH)
    page.goto(f"{URL}/?observer={observer}")
    page.wait_for_function("document.querySelectorAll('#screen .line').length > 0")
    return page


def same_text(tmux, page, seconds=60):
    """Waits until page and terminal have the same text; gives it."""
    until = time.monotonic() + seconds
    while True:
        screen = tmux.screen()
        text = page.evaluate(TEXT)
        if text == screen:
            return text
        assert time.monotonic() < until, f"the terminal has\n{screen}\n\nthe page has\n{text}"
        time.sleep(0.02)


def equals_the_terminal(tmux, page):
    """Opens and closes lists: after each the page has the terminal's text; how long after is told."""
    late_ms = []
    same_text(tmux, page)
    for key in ["?", "Escape", "C-f", "Escape"] * 5:
        before = tmux.screen()
        tmux.key(key)
        until = time.monotonic() + 60
        while (screen := tmux.screen()) == before:
            assert time.monotonic() < until, f"{key} does nothing:\n{before}"
            time.sleep(0.005)
        changed = time.time() * 1000
        same_text(tmux, page)
        seen = page.evaluate("seen")
        found = [one["at"] for one in seen if one["text"] == screen and one["at"] > changed - 5000]
        # What changed once more before it was looked at is not measured.
        late_ms += [max(0, found[-1] - changed)] if found else []
    worst = max(late_ms)
    print(f"{len(late_ms)} changes of the screen: the page has the terminal's text {percentile(late_ms, 0.5):.0f} ms later at the median, "
          f"{worst:.0f} ms at most" + ("" if worst <= LIMIT_MS else f": more than {LIMIT_MS} ms, on a machine that is not idle?"), flush=True)


def looks_like_it(tmux, page, folder):
    """Colours, weights, and that every sign stands in its column."""
    runs = page.evaluate("""[...document.querySelectorAll('#screen .run')].map((run) => {
        const { left, width } = run.getBoundingClientRect(), { color, fontWeight } = getComputedStyle(run);
        return { left, width, text: run.textContent, color, bold: fontWeight >= 600 }; })""")
    assert len({run["color"] for run in runs}) > 3 and any(run["bold"] for run in runs), runs[:20]
    cell = page.evaluate("document.getElementById('screen').getBoundingClientRect().width") / 120
    left = min(run["left"] for run in runs)
    off = [run for run in runs if abs((run["left"] - left) / cell - round((run["left"] - left) / cell)) > 0.1]
    assert not off, off[:5]
    page.screenshot(path=folder / "observers.png")
    print(f"{len(runs)} stretches of cells in {len({run['color'] for run in runs})} colours, each in its columns", flush=True)


def remarks(tmux, page):
    page.fill("#note", "looks at the pot")
    page.keyboard.press("Enter")
    page.wait_for_function("document.getElementById('told').textContent.includes('Saved as a note of O1')")
    assert page.input_value("#note") == ""
    (recording,) = tmux.out.iterdir()
    notes = [(event["note"], event["observer"]) for event in recorded(recording, "marker")]
    assert notes == [("looks at the pot", "O1")], notes


def is_asked_for_a_code(chromium):
    page = chromium.new_context(bypass_csp=True).new_page()
    page.goto(URL)
    page.wait_for_selector("#pairing:not([hidden])")
    assert page.is_hidden("#needs-code") and page.evaluate(TEXT) == "", "the screen is seen before"
    page.fill("#observer", "Anna Berg")
    page.keyboard.press("Enter")
    page.wait_for_function("document.getElementById('wrong').textContent !== ''")
    page.fill("#observer", "O2")
    page.keyboard.press("Enter")
    page.wait_for_function("document.querySelectorAll('#screen .line').length > 0")
    assert page.is_hidden("#pairing")
    page.close()


def join(observer, opened):
    client = opened.enter_context(connect(f"ws://127.0.0.1:{PORT}/talk", max_size=None))
    client.send(json.dumps({"kind": "hello", "page": observer, "observer": observer, "code": None}))
    return client, json.loads(client.recv(timeout=30))


def lets_twenty_in(chromium):
    """One page is open; nineteen more join, the next one is told why it cannot."""
    with ExitStack() as opened:
        clients = []
        for number in range(19):
            client, answer = join(f"W{number}", opened)
            assert answer == {"kind": "welcome", "observer": f"W{number}"}, answer
            clients.append(client)
        _, answer = join("late", opened)
        assert answer == {"kind": "full", "most": 20}, answer
        page = chromium.new_context(bypass_csp=True).new_page()
        page.goto(f"{URL}/?observer=late2")
        page.wait_for_function("document.getElementById('told').textContent.includes('20 observers watch already')")
        page.close()
        for client in clients:
            while json.loads(client.recv(timeout=30))["kind"] != "frame":
                pass
    print("twenty observers watch, the next one is told so", flush=True)


def nobody_is_waited_for(tmux, page):
    """An observer whose connection takes nothing any more."""
    stalled = socket.create_connection(("127.0.0.1", PORT))
    stalled.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    stalled.sendall(f"GET /talk HTTP/1.1\r\nHost: 127.0.0.1:{PORT}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode())
    stalled.recv(1000)
    hello = json.dumps({"kind": "hello", "page": "stalled", "observer": "S1", "code": None}).encode()
    stalled.sendall(bytes([0x81, 0x80 | len(hello)]) + bytes(4) + hello)
    tmux.key("C-f")
    tmux.wait_for("2 of at most 20 watch")
    tmux.key("Escape")
    while LIST in tmux.screen():
        time.sleep(0.02)
    slowest = 0
    for _ in range(40):
        for key, is_open in [("C-f", True), ("Escape", False)]:
            asked = time.monotonic()
            tmux.key(key)
            while (LIST in tmux.screen()) != is_open:
                assert time.monotonic() < asked + 60, tmux.screen()
            slowest = max(slowest, time.monotonic() - asked)
    same_text(tmux, page)
    stalled.close()
    print(f"one observer reads nothing: 80 keys are on the screen at most {1000 * slowest:.0f} ms later, and on the page of another one", flush=True)


if __name__ == "__main__":
    tomcom, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    command = ["operate", "sessions/default.toml", f"--observe=127.0.0.1:{PORT}", "--condition", "wizard"]
    with Tmux(tomcom, folder / "recordings", *command) as tmux, browser() as chromium:
        is_asked_for_a_code(chromium)
        page = open_page(chromium, "O1")
        equals_the_terminal(tmux, page)
        looks_like_it(tmux, page, folder)
        remarks(tmux, page)
        lets_twenty_in(chromium)
        nobody_is_waited_for(tmux, page)
        assert not page.errors, page.errors
        recording = tmux.quit()
        page.wait_for_function("document.getElementById('told').textContent !== ''")
    verify(tomcom, recording)
