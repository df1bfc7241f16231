"""Resident memory of a live session that is streamed to Rerun's viewers: gaze at 120 Hz, the arm in the physics, one viewer that
reads and one that is stopped (SIGSTOP).

    tests/outside/memory.py TOMCOM FOLDER [--minutes 20] [--hz 120] [--most 200] [--growth 6]
"""

import os
import signal
import subprocess
import sys
import time

from console import Console, parser, session_file
from latency import SENDER
from stream import RERUN, rows_of, run

PORT = 20400
ADDRESS = "127.0.0.1:20312"


def viewer(file, port):
    """Rerun's own program, which takes the stream as a viewer does, and puts it into a file. It listens at a port itself."""
    command = [RERUN, f"rerun+http://{ADDRESS}/proxy", "--save", file, "--port", str(port)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def measure(arguments, folder):
    session = session_file(folder, gaze="json", gaze_port=PORT)
    session.write_text(session.read_text() + '[robot]\narm = "physics"\n')
    console = Console(arguments.tomcom, [session, "--out", folder / "recordings", "--rerun-listen", ADDRESS])
    viewers, resident, minutes = [], [], []
    with console:
        console.wait_for("READY")
        (recording,) = (folder / "recordings").iterdir()
        sender = subprocess.Popen([sys.executable, "-c", SENDER, str(PORT), str(arguments.hz)])
        try:
            console.wait_for(r"gaze +\d+ Hz")
            console.start()
            viewers = [viewer(folder / f"{name}.rrd", PORT + nth) for nth, name in ((1, "reads"), (2, "stopped"))]
            time.sleep(10)
            assert all(one.poll() is None for one in viewers), "a viewer ended by itself"
            viewers[1].send_signal(signal.SIGSTOP)
            began = time.monotonic()
            while time.monotonic() < began + 60 * arguments.minutes:
                time.sleep(min(15, 60 * arguments.minutes / 8))
                resident.append(console.rss_bytes() / 1e6)
                minutes.append((time.monotonic() - began) / 60)
                file = (recording / "recording.rrd").stat().st_size / 1e6
                read = (folder / "reads.rrd").stat().st_size / 1e6
                print(f"  {minutes[-1]:5.1f} min: {resident[-1]:6.1f} MB resident, file {file:.1f} MB, read {read:.1f} MB", flush=True)
                assert sender.poll() is None, "the tracker was cut off"
        finally:
            for one in [sender, *viewers]:
                one.kill()
                one.wait()
        console.quit()
    return recording, resident, minutes


def main():
    asked = parser(__doc__)
    asked.add_argument("--minutes", type=float, default=20)
    asked.add_argument("--hz", type=int, default=120, help="gaze samples a second")
    asked.add_argument("--most", type=float, default=200, help="MB that may be resident")
    asked.add_argument("--growth", type=float, default=6, help="MB a minute that it may grow by in the second half of 10 minutes or more")
    arguments = asked.parse_args()
    run(RERUN, "analytics", "disable")
    folder = arguments.folder / f"memory-{os.getpid()}"
    recording, resident, minutes = measure(arguments, folder)
    half = len(resident) // 2
    growth = (resident[-1] - resident[half]) / (minutes[-1] - minutes[half])
    print(f"gaze at {arguments.hz} Hz, {arguments.minutes} minutes: at most {max(resident):.0f} MB resident, in the second half {growth:.1f} MB more a minute")
    assert max(resident) <= arguments.most, f"more than {arguments.most} MB"
    # Within the first minutes the messages that are kept for viewers fill up to their bound.
    if arguments.minutes >= 10:
        assert growth <= arguments.growth, f"it grows by more than {arguments.growth} MB a minute"
    run(RERUN, "rrd", "verify", recording / "recording.rrd")
    # The viewer that read has what the file has but for the gaze, of which viewers get less; it was ended with the session.
    gaze = {name: len(rows_of(stream)["human/gaze"]) for name, stream in (("file", recording / "recording.rrd"), ("read", folder / "reads.rrd"))}
    print(f"  gaze: {gaze['file']} samples in the file, {gaze['read']} sent to a viewer")
    assert gaze["read"] > gaze["file"] * 25 / arguments.hz * 0.8, "the viewer got too little"
    assert gaze["read"] < gaze["file"] * 31 / arguments.hz, "the gaze for viewers is not thinned"


if __name__ == "__main__":
    main()
