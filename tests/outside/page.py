"""The participant's page in a real browser: Chromium of the system, driven by Playwright."""

import json
import re
import shutil
import subprocess
import threading
import time
from contextlib import contextmanager

from playwright.sync_api import sync_playwright

# A gamepad with the standard buttons, which a test presses by setting `pressed`.
GAMEPAD = """
const pad = { index: 0, id: "mock", connected: true, mapping: "standard", timestamp: 0, axes: [0, 0, 0, 0],
  buttons: Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 })) };
window.pad = pad;
navigator.getGamepads = () => [pad, null, null, null];
"""


@contextmanager
def browser(*more):
    """Chromium, with these arguments beside the usual ones."""
    path = shutil.which("chromium")
    assert path, "Debian's package chromium is needed"
    arguments = ["--no-sandbox", "--disable-background-networking", "--disable-sync", "--disable-component-update", *more]
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=path, args=arguments)
        try:
            yield made
        finally:
            made.close()


class Page:
    """A page of the display, with what it says to the program."""

    def __init__(self, browser, url, size=(1920, 1080), touch=False, code=None, files=None, more=""):
        """`more`: a script that runs before those of the page; `files`: a folder whose files stand in for those that the program serves."""
        self.context = browser.new_context(viewport={"width": size[0], "height": size[1]}, has_touch=touch, bypass_csp=True)
        self.context.add_init_script(GAMEPAD + more)
        self.page = self.context.new_page()
        if files:
            self.page.route(re.compile(r"\.(js|css)$"), lambda route: route.fulfill(path=files / route.request.url.rsplit("/", 1)[1]))
        self.errors, self.said, self.lock = [], [], threading.Lock()
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        # From a press until the page knows its effect, in milliseconds, for every press that had one.
        self.answered_ms, self.pressed = [], None
        # What the page was told of the robot, message by message.
        self.robot = []
        self.page.on("websocket", self.listen)
        self.page.goto(url + (f"/?code={code}" if code else ""))

    def listen(self, socket):
        socket.on("framesent", self.note)
        socket.on("framereceived", self.hear)

    def note(self, payload):
        message = json.loads(payload)
        with self.lock:
            self.said.append(message)
            if message["kind"] == "press":
                self.pressed = time.perf_counter()

    def hear(self, payload):
        with self.lock:
            message = json.loads(payload)
            if message["kind"] == "robot":
                self.robot.append(message)
            if self.pressed is not None and message["kind"] == "sight":
                self.answered_ms.append(1000 * (time.perf_counter() - self.pressed))
                self.pressed = None

    def wait_for(self, script, seconds=15):
        self.page.wait_for_function(script, timeout=1000 * seconds)

    def ask(self, script):
        return self.page.evaluate(script)

    def stage(self, name):
        self.wait_for(f"document.getElementById('stage').dataset.stage === '{name}'")

    def presses(self):
        return self.ask("Stage.shown().presses[0] ? Stage.shown().presses[0].number : 0")

    def orders(self):
        """What the orders want, as the page shows it."""
        return self.ask("""Stage.scene().locations.map((spot, index) => [spot.kind, Stage.shown().contents[index]])
            .filter(([kind]) => kind === "order").map(([, what]) => what.dish || null)""")

    def push(self, number):
        """Pushes a button of the gamepad, and lets it go; 17 and 18 are its sticks, which are pushed down."""
        stick = {17: 1, 18: 3}.get(number)
        for is_down in ("true", "false"):
            self.ask(f"pad.buttons[{number}].pressed = {is_down}" if stick is None else f"pad.axes[{stick}] = Number({is_down})")
            self.page.wait_for_timeout(20)

    def press(self, button, way):
        """Presses a button in this way, and waits until the page shows that it was taken."""
        before = self.presses()
        knob = self.ask(f"Stage.scene().buttons.find((button) => button.name === {json.dumps(button)})")
        if way == "keyboard":
            self.page.keyboard.press(knob["key"])
        elif way == "touch":
            # At once, as a finger does, also where a hint makes the button beat.
            self.page.locator(f'[data-button="{button}"]').tap(force=True)
        else:
            self.push(knob["gamepad"])
        self.wait_for(f"Stage.shown().presses[0] && Stage.shown().presses[0].number > {before}")
        self.page.wait_for_timeout(60)

    def screenshot(self, path):
        self.page.screenshot(path=str(path))

    def close(self):
        assert not self.errors, self.errors
        self.context.close()


def has_font(language):
    """Whether this machine has a font for the language."""
    return bool(subprocess.run(["fc-list", f":lang={language}"], capture_output=True, check=True).stdout)


def plain(text):
    """Words of a screen without what breaks lines."""
    return re.sub(r"\s+", " ", text)
