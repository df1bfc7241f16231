"""Prints what happens in a running session, as the Lab Streaming Layer sends it: the time on this computer's LSL clock, and the short code.

    lsl_consumer.py [SECONDS]

Needs pylsl. The session file asks for the stream: outlets = ["markers"] under [lsl]. Ends after so many seconds, or with ctrl-c.
"""

import sys
import time

try:
    from pylsl import StreamInlet, resolve_bypred
    from pylsl.util import LostError
except ModuleNotFoundError as missing:
    sys.exit(f"{missing.name} is not installed: pip install pylsl")


def follow(seconds):
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        streams = resolve_bypred("type='Markers' and starts-with(source_id,'tomcom-')", minimum=1, timeout=1)
        if not streams:
            continue
        # Without recovery the end of the program is noticed, and the next session is looked for.
        inlet = StreamInlet(streams[0], recover=False)
        print(f"# {streams[0].name()} on {streams[0].hostname()}", flush=True)
        try:
            while time.monotonic() < until:
                sample, stamp = inlet.pull_sample(timeout=0.5)
                if sample:
                    print(f"{stamp + inlet.time_correction():.6f} {sample[0]}", flush=True)
        except LostError:
            print("# the stream has ended", flush=True)


if __name__ == "__main__":
    try:
        follow(float(sys.argv[1]) if len(sys.argv) > 1 else float("inf"))
    except KeyboardInterrupt:
        pass
