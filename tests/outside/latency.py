"""Key to effect in the real program: a key is written to its terminal, the signal's event is looked for in the log and
its words on the screen, while gaze comes in at full rate. And what an idle console costs.

    tests/outside/latency.py TOMCOM FOLDER [--signals 1000] [--gap 0.6] [--rates 0 120 1000]
"""

import os
import random
import subprocess
import sys
import time

from console import Console, Log, parser, percentile, session_file

# Below the ports that a system gives to connections by itself: those may be taken.
PORT = 20123
# Highlights of the sushi kitchen: the key, and what is said of it. Orders come and go, places are always there.
SIGNALS = {
    "r": "robot hand", "a": "assembly board", "l": "plate", "n": "counter",
    "c": "cutting board", "p": "cooking pot", "m": "rolling mat",
}
# At most so much from the key to the event in the log, in seconds, at the 99th percentile, and so much of a core.
LIMIT_S = 0.050
IDLE_SHARE = 0.02

SENDER = """
import json, math, socket, sys, time
tracker = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
tracker.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
hz, start, sent = float(sys.argv[2]), time.monotonic(), 0
while True:
    t = time.monotonic() - start
    lines = b""
    while sent <= t * hz:
        lines += json.dumps({"t": sent / hz, "x": 0.5 + 0.4 * math.cos(sent / 50), "y": 0.5, "confidence": 0.9}).encode()
        lines += b"\\n"
        sent += 1
    tracker.sendall(lines)
    time.sleep(1 / hz)
"""


def send(console, log, key, name):
    """Sends one signal; seconds from the key to its line in the log and to its words on the screen."""
    log.new_lines()
    console.watch(lambda rows: any(f"signal sent: highlight {name}" in row for row in rows))
    wanted = f'{{"highlight":"{name.replace(" ", "_")}"}}'.encode()
    pressed, logged = time.monotonic(), None
    console.key(key)
    while logged is None or console.drawn is None:
        if logged is None and any(b"signal_shown" in line and wanted in line for line in log.new_lines()):
            logged = time.monotonic()
        told = f"{key}: in the log: {logged is not None}, on the screen: {console.drawn is not None}"
        assert time.monotonic() < pressed + 10, f"{told}\n{console.text()}"
        time.sleep(0.001)
    return logged - pressed, console.drawn - pressed


def send_many(console, log, signals, gap_s, chance, how):
    """Sends signals, tells how long they took, and gives the seconds to the log."""
    cpu_s, began = console.cpu_s(), time.monotonic()
    logged, drawn, last = [], [], None
    for _ in range(signals):
        last = chance.choice([key for key in SIGNALS if key != last])
        # Not in step with frames and ticks.
        time.sleep(gap_s * chance.uniform(0.8, 1.2))
        to_log, to_screen = send(console, log, last, SIGNALS[last])
        logged.append(to_log)
        drawn.append(to_screen)
    share = (console.cpu_s() - cpu_s) / (time.monotonic() - began)
    figures = [f"{name} p50 {1000 * percentile(values, 0.5):.1f} ms, p99 {1000 * percentile(values, 0.99):.1f} ms"
               for name, values in [("log", logged), ("screen", drawn)]]
    print(f"{signals} signals by key, {how}: {'; '.join(figures)}; {100 * share:.1f} % of a core", flush=True)
    return logged


def begin(tomcom, folder, hz):
    gaze = {"gaze": "json", "gaze_port": PORT + hz} if hz else {}
    console = Console(tomcom, [session_file(folder, **gaze), "--out", folder / "recordings"])
    console.wait_for("READY")
    (recording,) = (folder / "recordings").iterdir()
    return console, Log(recording)


def measure(tomcom, folder, signals, gap_s, hz):
    console, log = begin(tomcom, folder, hz)
    chance = random.Random(1)
    sender = None
    with console:
        if hz:
            sender = subprocess.Popen([sys.executable, "-c", SENDER, str(PORT + hz), str(hz)])
            # Without gaze that arrives the trial would not start at once.
            console.wait_for(r"gaze +\d+ Hz")
        console.start()
        time.sleep(2)
        source = f"JSON gaze at {hz} Hz" if hz else "simulated gaze"
        logged = send_many(console, log, signals, gap_s, chance, source)
        if sender:
            assert sender.poll() is None, "the tracker was cut off"
            sender.kill()
            sender.wait()
        console.quit()
    assert percentile(logged, 0.99) <= LIMIT_S, "a signal took too long"


def idle(tomcom, folder, seconds):
    console, _ = begin(tomcom, folder, 0)
    with console:
        time.sleep(1)
        cpu_s = console.cpu_s()
        time.sleep(seconds)
        share = (console.cpu_s() - cpu_s) / seconds
        console.quit()
    print(f"an idle console: {100 * share:.2f} % of a core", flush=True)
    assert share < IDLE_SHARE, "an idle console costs too much"


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("--signals", type=int, default=1000)
    asked.add_argument("--gap", type=float, default=0.6, help="seconds between signals")
    asked.add_argument("--rates", type=int, nargs="*", default=[0, 120, 1000], help="of the gaze in Hz; 0: simulated")
    arguments = asked.parse_args()
    idle(arguments.tomcom, arguments.folder / f"idle-{os.getpid()}", 10)
    for rate in arguments.rates:
        folder = arguments.folder / f"gaze-{rate}-{os.getpid()}"
        measure(arguments.tomcom, folder, arguments.signals, arguments.gap, rate)
