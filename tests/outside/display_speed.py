"""How fast the participant's display answers: the real program, a real browser, and the way from a press to the screen.

    tests/outside/display_speed.py TOMCOM FOLDER [--presses 200]
"""

import os
import subprocess
import sys
from pathlib import Path

from console import parser, percentile
from display import PORT, SIZE, operate, session_file, start, url, verified
from page import Page, browser

# Asked for on an idle machine, where nothing but software draws the page, at 1280x800: frames a second, and milliseconds from a
# press to its effect on the screen at the 99th percentile. Three times worse in each of some attempts fails, in the attack three times
# worse than without it: browser, program and this script share two cores, and other work may take them for a while.
FRAMES_HZ, SCREEN_MS, WORSE, ATTEMPTS = 55, 40, 3, 3


def is_quick(tomcom, browser, folder, presses):
    """From press to screen, alone and with 200 connections that send nonsense a thousand times a second."""
    console = operate(tomcom, session_file(folder, "sushi", 1, shadow="on", presses=10_000), folder)
    with console:
        page = Page(browser, url(), size=SIZE)
        start(console, page, robot_held=False)
        alone_ms = measure(page, presses, "alone", SCREEN_MS)
        abuse = subprocess.Popen([sys.executable, Path(__file__).with_name("abuse.py"), str(PORT)], stdout=subprocess.PIPE, text=True)
        try:
            assert abuse.stdout.readline().strip() == "200 connections"
            measure(page, presses, "with 200 connections that send 1,000 messages of nonsense a second", max(alone_ms, SCREEN_MS))
            assert abuse.poll() is None, "the connections were all lost"
        finally:
            abuse.kill()
            abuse.wait()
        page.close()
        console.quit()
    verified(tomcom, folder)


def measure(page, presses, how, asked_ms):
    """Milliseconds from a press to the screen at the 99th percentile, in the first attempt that is good enough."""
    for _ in range(ATTEMPTS):
        frames_hz, drawn_ms = attempt(page, presses, how)
        if frames_hz >= FRAMES_HZ / WORSE and drawn_ms <= WORSE * asked_ms:
            return drawn_ms
    raise AssertionError(f"{how}: {frames_hz:.1f} frames a second, {drawn_ms:.1f} ms from a press to the screen (at most {WORSE} times {asked_ms:.1f})")


def attempt(page, presses, how):
    first, answered = len(page.said), len(page.answered_ms)
    page.ask("""() => {
        let last = performance.now();
        window.frames_ms = [];
        const tick = (now) => { window.frames_ms?.push(now - last); last = now; if (window.frames_ms) requestAnimationFrame(tick); };
        requestAnimationFrame(tick);
    }""")
    for number in range(presses):
        page.press("take rice" if number % 2 == 0 else "trash", "keyboard")
    page.page.wait_for_timeout(300)
    frames_ms = page.ask("() => { const frames = window.frames_ms; window.frames_ms = null; return frames; }")[1:]
    took = [message["took"] for message in page.said[first:] if message["kind"] == "redrawn"]
    answers = page.answered_ms[answered:]
    assert min(len(took), len(answers)) >= 0.95 * presses, f"{len(took)} of {presses} presses were drawn"
    frames_hz, drawn_ms = 1000 * len(frames_ms) / sum(frames_ms), percentile(took, 0.99)
    verdict = "as asked" if frames_hz >= FRAMES_HZ and drawn_ms < SCREEN_MS else f"asked: {FRAMES_HZ} frames, {SCREEN_MS} ms"
    print(f"{len(took)} presses at {SIZE[0]}x{SIZE[1]} {how}: answered p50 {percentile(answers, 0.5):.1f} ms, p99 {percentile(answers, 0.99):.1f} ms; "
          f"key to screen p50 {percentile(took, 0.5):.1f} ms, p99 {drawn_ms:.1f} ms; {frames_hz:.1f} frames a second, the longest of 100 takes "
          f"{percentile(frames_ms, 0.99):.1f} ms ({verdict})", flush=True)
    return frames_hz, drawn_ms


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("--presses", type=int, default=200, help="whose way to the screen is measured")
    arguments = asked.parse_args()
    with browser() as chromium:
        is_quick(arguments.tomcom, chromium, arguments.folder, arguments.presses)
    # All is checked. Libraries in C may crash while the interpreter is taken down, which says nothing of the program.
    sys.stdout.flush()
    os._exit(0)
