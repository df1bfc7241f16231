"""A browser over WebDriver BiDi, by a small client: Debian's Firefox, which Playwright does not drive."""

import base64
import itertools
import json
import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from websockets.sync.client import connect

PROGRAM = "firefox-esr"
# The browser asks nothing of the network and shows nothing of its own.
SETTINGS = {
    "app.normandy.enabled": False, "app.update.enabled": False, "browser.aboutwelcome.enabled": False, "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False, "extensions.update.enabled": False, "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False, "services.settings.server": "data:,", "toolkit.telemetry.enabled": False,
}


def is_there():
    return shutil.which(PROGRAM) is not None


class Firefox:
    """A window of Firefox without a screen, until it is left by `with`."""

    def __init__(self, size):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in SETTINGS.items()]
        Path(self.profile.name, "user.js").write_text("\n".join(lines))
        # The browser takes a free port and says which.
        self.process = subprocess.Popen([PROGRAM, "--headless", "--no-remote", "--profile", self.profile.name, "--remote-debugging-port", "0"],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        for line in self.process.stderr:
            if found := re.search(r"WebDriver BiDi listening on (ws://\S+)", line):
                break
        else:
            raise AssertionError("Firefox does not say where it listens")
        self.socket = connect(f"{found[1]}/session", max_size=None, open_timeout=30)
        self.numbers = itertools.count(1)
        self.version = self.command("session.new", capabilities={})["capabilities"]["browserVersion"]
        self.context = self.command("browsingContext.getTree")["contexts"][0]["context"]
        self.command("browsingContext.setViewport", context=self.context, viewport={"width": size[0], "height": size[1]})

    def command(self, method, **params):
        """Sends a command and returns its result; events meanwhile are dropped."""
        number = next(self.numbers)
        self.socket.send(json.dumps({"id": number, "method": method, "params": params}))
        while True:
            message = json.loads(self.socket.recv(timeout=60))
            if message.get("id") == number:
                assert message["type"] == "success", message
                return message["result"]

    def open(self, url):
        self.command("browsingContext.navigate", context=self.context, url=url, wait="complete")

    def ask(self, script):
        """The value of an expression, by way of JSON."""
        answer = self.command("script.evaluate", expression=f"JSON.stringify({script})", target={"context": self.context}, awaitPromise=True)
        assert answer["type"] == "success", answer
        return json.loads(answer["result"]["value"]) if answer["result"]["type"] == "string" else None

    def wait_for(self, script, seconds=15):
        until = time.monotonic() + seconds
        while not self.ask(f"Boolean({script})"):
            assert time.monotonic() < until, f"{script} did not become true"
            time.sleep(0.03)

    def key(self, key):
        actions = [{"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]
        self.command("input.performActions", context=self.context, actions=[{"type": "key", "id": "keyboard", "actions": actions}])

    def screenshot(self, path):
        """A picture of the page, once nothing moves on it any more."""
        time.sleep(0.8)
        Path(path).write_bytes(base64.b64decode(self.command("browsingContext.captureScreenshot", context=self.context)["data"]))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()
        self.process.terminate()
        self.process.wait(30)
        self.process.stderr.close()
        self.profile.cleanup()
