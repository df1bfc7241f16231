"""Whoever should not get in, does not, and keeps nobody out: websites in a real browser, silent connections, guesses.

    tests/outside/intruders.py TOMCOM FOLDER [CHECK ...]
"""

import json
import os
import socket
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from console import Console
from page import Page, browser, plain
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

# Below the ports that a system gives to connections by itself: those may be taken.
DISPLAY, GAZE, FOREIGN = 20341, 20342, 20343
# A name that begins like an address of this machine. Whoever owns it may let it resolve to this machine.
EVIL = "127.evil.example"
REBINDING = f"--host-resolver-rules=MAP {EVIL} 127.0.0.1"
SILENT = 520
# A usual limit of open files.
FILES = 1024
SAMPLE = {"x": 0.25, "y": 0.75, "confidence": 0.9}
FOREIGN_SAMPLE = {"x": 0.111, "y": 0.222, "confidence": 0.999}


def session_file(folder, kind, gaze):
    folder.mkdir(parents=True, exist_ok=True)
    layout = Path("layouts/sushi.toml").resolve()
    path = folder / "session.toml"
    path.write_text(f'layout = "{layout}"\n[participant]\nkind = "{kind}"\ngaze = "{gaze}"\ngaze_port = {GAZE}\n'
                    f'[display]\nport = {DISPLAY}\n[trial]\npresses = 100000\nseconds = 86400.0\n')
    return path


@contextmanager
def operate(tomcom, folder, kind, gaze, *more, files=None):
    arguments = [session_file(folder, kind, gaze), "--out", folder / "recordings", *more]
    with Console(tomcom, arguments, files=files) as console:
        console.wait_for("READY|NO DISPLAY")
        yield console


def recorded(folder):
    (recording,) = (folder / "recordings").iterdir()
    text = (recording / "events.jsonl").read_text()
    return text, [json.loads(line) for line in text.splitlines()[1:]]


class Site(BaseHTTPRequestHandler):
    """A website: an empty page."""

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<!doctype html><title>a website</title>")

    def log_message(self, *_):
        pass


@contextmanager
def website():
    server = ThreadingHTTPServer(("127.0.0.1", FOREIGN), Site)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield server
    finally:
        server.shutdown()
        server.server_close()


@contextmanager
def abuse(port, *arguments):
    """Connections that nobody wants, once they are all there."""
    command = [sys.executable, Path(__file__).with_name("abuse.py"), str(port), *map(str, arguments)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert "connections" in process.stdout.readline()
        yield process
        assert process.poll() is None, "the connections ended"
    finally:
        process.kill()
        process.wait()


# Connects to the display as its page does; what came of it.
TALK = """(host) => new Promise((done) => {
    const socket = new WebSocket(`ws://${host}/talk`);
    socket.onopen = () => socket.send(JSON.stringify({ kind: "hello", page: "foreign", width: 800, height: 600, code: null }));
    socket.onmessage = ({ data }) => JSON.parse(data).kind === "role" && done(data);
    socket.onclose = () => done("closed");
})"""


def cannot_rebind(tomcom, folder):
    """A website whose name resolves to this machine, from its own port and from the display's."""
    with operate(tomcom, folder, "display", "none") as console, website(), browser(REBINDING) as chromium:
        page = chromium.new_context().new_page()
        answer = page.goto(f"http://{EVIL}:{DISPLAY}/")
        assert answer.status == 403, answer.status
        # As if its page had come from there before the name resolved to this machine.
        page.route(f"http://{EVIL}:{DISPLAY}/own", lambda route: route.fulfill(body="<title>evil</title>", content_type="text/html"))
        page.goto(f"http://{EVIL}:{DISPLAY}/own")
        assert page.evaluate("location.host") == f"{EVIL}:{DISPLAY}"
        for origin in [f"http://{EVIL}:{DISPLAY}/own", f"http://{EVIL}:{FOREIGN}/", f"http://127.0.0.1:{FOREIGN}/"]:
            page.goto(origin)
            for host in [f"{EVIL}:{DISPLAY}", f"127.0.0.1:{DISPLAY}", f"localhost:{DISPLAY}"]:
                found = page.evaluate(TALK, host)
                assert found == "closed", f"{origin} got into {host}: {found}"
        console.wait_for("NO DISPLAY")
        # The same from the program's own page.
        own = chromium.new_context().new_page()
        own.goto(f"http://localhost:{DISPLAY}/")
        own.wait_for_function("document.getElementById('stage').dataset.stage === 'welcome'", timeout=15000)
        console.quit()
    print(f"pages of {EVIL} and of another port connect to nothing; the program's own page does", flush=True)


# A website sends gaze in all the ways in which browsers let it send to other places.
INJECT = """async ([port, lines]) => {
    const url = `http://127.0.0.1:${port}/`;
    await fetch(url, { method: "POST", mode: "no-cors", body: lines }).catch(() => {});
    await fetch(url, { method: "POST", mode: "no-cors", body: lines, headers: { "Content-Type": "text/plain" } }).catch(() => {});
    navigator.sendBeacon(url, lines);
    await fetch(url + "?" + encodeURIComponent(lines), { mode: "no-cors" }).catch(() => {});
    await new Promise((done) => {
        const socket = new WebSocket(`ws://127.0.0.1:${port}/`);
        socket.onclose = socket.onopen = done;
    });
    const form = document.createElement("form");
    Object.assign(form, { method: "post", action: url, enctype: "text/plain", target: "_blank" });
    const field = document.createElement("input");
    Object.assign(field, { name: lines, value: "" });
    form.append(field);
    document.body.append(form);
    form.submit();
}"""


def cannot_inject_gaze(tomcom, folder):
    lines = (json.dumps(FOREIGN_SAMPLE) + "\n") * 50
    with operate(tomcom, folder, "keyboard", "json") as console, website(), browser() as chromium:
        tracker = socket.create_connection(("127.0.0.1", GAZE))
        send(tracker, 30)
        page = chromium.new_context().new_page()
        page.goto(f"http://localhost:{FOREIGN}/")
        page.evaluate(INJECT, [GAZE, lines])
        # However often it tries, the browser is one sender.
        console.wait_for("1 sender rejected")
        # The tracker goes on, also with datagrams.
        send(tracker, 30)
        datagrams = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        other.bind(("127.0.0.2", 0))
        for _ in range(30):
            datagrams.sendto(json.dumps(SAMPLE).encode(), ("127.0.0.1", GAZE))
            time.sleep(0.01)
            other.sendto(json.dumps(FOREIGN_SAMPLE).encode(), ("127.0.0.1", GAZE))
        console.wait_for("2 senders rejected")
        console.quit()
    text, events = recorded(folder)
    gaze = [event for event in events if event["kind"] == "gaze"]
    assert len(gaze) == 90 and all(event["x"] == SAMPLE["x"] for event in gaze), len(gaze)
    assert str(FOREIGN_SAMPLE["x"]) not in text and '"dropped"' not in text, "something of a website is in the log"
    print(f"gaze of a website (POST, beacon, GET, WebSocket, form) and of another address: both rejected, nothing in the log", flush=True)


def send(tracker, samples):
    for _ in range(samples):
        tracker.sendall(json.dumps(SAMPLE).encode() + b"\n")
        time.sleep(0.01)


def joins_among_the_silent(tomcom, folder):
    with operate(tomcom, folder, "display", "mouse") as console, browser() as chromium:
        with abuse(DISPLAY, "--silent", SILENT):
            began = time.monotonic()
            page = Page(chromium, f"http://127.0.0.1:{DISPLAY}")
            page.stage("welcome")
            page.wait_for("!document.getElementById('stage').classList.contains('lost')")
            console.wait_for("display")
            joined_s = time.monotonic() - began
            page.page.evaluate("document.body.dataset.same = 'page'")
            # It stays, for longer than a silent page would, and acts.
            lost = len([message for message in page.said if message["kind"] == "hello"])
            time.sleep(12)
            assert page.ask("document.body.dataset.same") == "page"
            assert len([message for message in page.said if message["kind"] == "hello"]) == lost == 1, "it had to connect again"
            page.page.reload()
            page.stage("welcome")
            page.wait_for("!document.querySelector('.toast.open')")
            page.close()
        console.wait_for("NO DISPLAY")
        console.quit()
    print(f"among {SILENT} silent connections a page joined in {joined_s:.1f} s, stayed, and was loaded again", flush=True)


def stays_while_nobody_sees_it(tomcom, folder):
    """A browser slows the timers of a page down that nobody sees, and answers pings all the same."""
    with operate(tomcom, folder, "display", "none") as console:
        page = {"kind": "hello", "page": "hidden", "width": 800, "height": 600, "code": None}
        visible = page | {"page": "visible", "waits": True}
        with connect(f"ws://127.0.0.1:{DISPLAY}/talk", ping_interval=None) as hidden, \
                connect(f"ws://127.0.0.1:{DISPLAY}/talk", ping_interval=None) as silent:
            hidden.send(json.dumps(page))
            hidden.send(json.dumps({"kind": "ping", "t": 0, "took": None, "hidden": True}))
            silent.send(json.dumps(visible))
            until = time.monotonic() + 20
            ended = None
            while time.monotonic() < until:
                for one in [hidden, silent]:
                    try:
                        one.recv(timeout=0.5)
                    except TimeoutError:
                        pass
                    except ConnectionClosed:
                        assert one is silent, "the page that nobody sees was closed"
                        ended = ended or time.monotonic()
            assert ended, "a visible page that says nothing is still there"
        console.quit()
    print("a hidden page whose browser answers pings stays; a visible one that says nothing is closed", flush=True)


def cannot_guess(tomcom, folder):
    with operate(tomcom, folder, "display", "none", "--listen", "0.0.0.0") as console, browser() as chromium:
        console.key("\x06")
        console.wait_for(r"pairing code [A-Z0-9]{6}")
        code = plain(console.text()).split("pairing code ")[1][:6]
        guessing = subprocess.Popen([sys.executable, Path(__file__).with_name("abuse.py"), str(DISPLAY), "--guess", "400"],
                                    stdout=subprocess.PIPE, text=True)
        try:
            time.sleep(4)
            page = Page(chromium, f"http://127.0.0.1:{DISPLAY}", code=code)
            page.stage("welcome")
            answers = json.loads(guessing.communicate(timeout=120)[0])
        finally:
            guessing.kill()
            guessing.wait()
        page.close()
        console.key("\x1b")
        time.sleep(0.3)
        console.quit()
    # 1, 1, 1, 1, 2, 4, 8 s: seven in ten seconds, one more while the last ones end.
    assert 1 <= answers["wrong"] <= 8, answers
    print(f"400 connections guessed for ten seconds: {answers['wrong']} codes were looked at, {answers['locked']} were not; "
          "a page with the right code joined meanwhile", flush=True)


def has_descriptors_left(tomcom, folder):
    """With few descriptors, and silent connections at every listener, trackers and pages get in."""
    with operate(tomcom, folder, "display", "json", files=FILES) as console, browser() as chromium:
        with abuse(GAZE, "--silent", 600), abuse(DISPLAY, "--silent", 600):
            used = len(list(Path(f"/proc/{console.process.pid}/fd").iterdir()))
            page = Page(chromium, f"http://127.0.0.1:{DISPLAY}")
            page.stage("welcome")
            tracker = socket.create_connection(("127.0.0.1", GAZE))
            for _ in range(50):
                send(tracker, 2)
            console.wait_for(r"gaze +\d+ Hz")
            # While they come and go: the first line is due after ten seconds.
            time.sleep(12)
            send(tracker, 10)
            page.close()
        console.quit()
    _, events = recorded(folder)
    gaze = [event for event in events if event["kind"] == "gaze"]
    assert len(gaze) == 110, len(gaze)
    assert used < FILES / 2, f"{used} descriptors in use"
    print(f"at {FILES} descriptors with 1,200 silent connections: {used} in use, a page and a tracker got in and stayed", flush=True)


def cpu_s(pid):
    """Processor time that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def cannot_stall_with_blanks(tomcom, folder):
    """A first line that never begins is closed at once, and costs the session nothing."""
    connections = 50
    with operate(tomcom, folder, "display", "json") as console:
        used_s, began = cpu_s(console.process.pid), time.monotonic()
        for _ in range(connections):
            stream = socket.create_connection(("127.0.0.1", GAZE))
            # A sender whose first line may still begin has ten seconds.
            stream.settimeout(5)
            try:
                for _ in range(256):
                    stream.sendall(b" " * 4096)
                assert stream.recv(1) == b"", "a sender of blanks got an answer"
            except ConnectionError:
                pass
            stream.close()
        used_s, took_s = cpu_s(console.process.pid) - used_s, time.monotonic() - began
        tracker = socket.create_connection(("127.0.0.1", GAZE))
        send(tracker, 100)
        console.wait_for(r"gaze +\d+ Hz")
        console.quit()
    assert used_s < 0.5 * took_s + 1, f"{used_s:.1f} s of processor time for blanks, in {took_s:.1f} s"
    print(f"{connections} connections with up to 1 MiB of blanks: closed at once, {used_s:.2f} s of processor time in {took_s:.1f} s", flush=True)


CHECKS = {
    "rebinding": cannot_rebind,
    "gaze": cannot_inject_gaze,
    "silent": joins_among_the_silent,
    "hidden": stays_while_nobody_sees_it,
    "guesses": cannot_guess,
    "descriptors": has_descriptors_left,
    "blanks": cannot_stall_with_blanks,
}


def main():
    tomcom, folder, *names = sys.argv[1:]
    for name in names or CHECKS:
        CHECKS[name](tomcom, Path(folder) / f"intruders-{os.getpid()}" / name)


if __name__ == "__main__":
    main()
    # All is checked. Libraries in C may crash while the interpreter is taken down, which says nothing of the program.
    sys.stdout.flush()
    os._exit(0)
