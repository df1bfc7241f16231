"""A viewer of Rerun beside a session with gaze at 200 Hz: connected, stopped (SIGSTOP), gone. The session has to be as quick
as without one, and what was recorded whole.

    tests/outside/viewer.py TOMCOM FOLDER [--signals 25]
"""

import random
import signal
import subprocess
import sys
import time

from console import Console, Log, parser, percentile, session_file, verify
from latency import LIMIT_S, PORT, SENDER, send_many
from stream import RERUN, compare, run

HZ = 200
ADDRESS = "127.0.0.1:20292"


def measure(console, log, signals, how):
    # What is still shown would not be shown anew.
    console.key("\x7f")
    logged = send_many(console, log, signals, 0.6, random.Random(how), how)
    assert percentile(logged, 0.9) <= LIMIT_S, "signals take too long"


def main():
    asked = parser(__doc__)
    asked.add_argument("--signals", type=int, default=25, help="in each state of the viewer")
    arguments = asked.parse_args()
    folder = arguments.folder
    run(RERUN, "analytics", "disable")
    session = session_file(folder, gaze="json", gaze_port=PORT + HZ)
    console = Console(arguments.tomcom, [session, "--out", folder / "recordings", "--rerun-listen", ADDRESS])
    with console:
        console.wait_for("READY")
        (recording,) = (folder / "recordings").iterdir()
        log = Log(recording)
        sender = subprocess.Popen([sys.executable, "-c", SENDER, str(PORT + HZ), str(HZ)])
        viewer = None
        try:
            console.wait_for(r"gaze +\d+ Hz|◉")
            console.start()
            time.sleep(2)
            measure(console, log, arguments.signals, "nobody looks on")
            viewer = subprocess.Popen([RERUN, f"rerun+http://{ADDRESS}/proxy", "--headless"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(5)
            assert viewer.poll() is None, "the viewer ended by itself"
            measure(console, log, arguments.signals, "a viewer looks on")
            viewer.send_signal(signal.SIGSTOP)
            measure(console, log, arguments.signals, "the viewer is stopped")
            viewer.kill()
            measure(console, log, arguments.signals, "the viewer is gone")
        finally:
            sender.kill()
            sender.wait()
            if viewer:
                viewer.kill()
                viewer.wait()
        console.quit()
    verify(arguments.tomcom, recording)
    run(RERUN, "rrd", "verify", recording / "recording.rrd")
    compare(recording / "recording.rrd", recording / "events.jsonl", least_presses=5)


if __name__ == "__main__":
    main()
