"""Sends samples of gaze to tomcom, as lines of JSON over TCP: what the bridges of the trackers have in common.

Not run by itself; see examples/neon_bridge.py and examples/tobii_bridge.py.
"""

import argparse
import json
import math
import socket
import sys
import time

# A sample of a tracker that is there and does not know where the eyes look. Confidence 0 is recorded, and nothing is concluded from it.
NOWHERE = {"x": 0.5, "y": 0.5, "confidence": 0.0}


def sample(point, t, age=None):
    """The line for a point on the display (fractions, origin at the top left; None: unknown), taken at `t`, in seconds of the tracker's
    own clock, and `age` seconds ago, if that is known."""
    is_known = point is not None and all(math.isfinite(value) for value in point)
    line = {"x": float(point[0]), "y": float(point[1]), "confidence": 1.0} if is_known else dict(NOWHERE)
    line["t"] = t
    if age is not None:
        # A clock that is compared to a millisecond can make a new sample a little younger than new.
        line["age"] = max(0.0, age)
    return line


class GazeSender:
    """A connection to tomcom, made anew whenever it is lost: tomcom may be started later than the tracker, and ended before it."""

    def __init__(self, to, code):
        self.to, self.code, self.connection, self.refused_until = to, code, None, 0.0

    def connect(self):
        connection = socket.create_connection(self.to, timeout=5)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if self.code:
            connection.sendall(json.dumps({"pair": self.code}).encode() + b"\n")
            answer = json.loads(connection.makefile().readline() or "{}")
            if answer.get("checked") is False and answer.get("wait_s"):
                # A wrong code came from here before; this one has not been looked at.
                raise OSError(f"no code is checked for {answer['wait_s']} s, after wrong ones")
            if not answer.get("paired"):
                sys.exit(f"tomcom does not take the pairing code {self.code}; its list of checks (^f) shows the right one")
        print(f"sends to {self.to[0]}:{self.to[1]}", flush=True)
        return connection

    def send(self, line):
        """Sends a sample, or drops it while nobody listens."""
        if time.monotonic() < self.refused_until:
            return
        try:
            self.connection = self.connection or self.connect()
            self.connection.sendall(json.dumps(line).encode() + b"\n")
        except OSError as reason:
            hint = "" if self.code or self.to[0].startswith("127.") else "; on another computer it wants --pair CODE"
            print(f"{self.to[0]}:{self.to[1]} does not take gaze ({reason}); trying again{hint}", file=sys.stderr, flush=True)
            self.connection, self.refused_until = None, time.monotonic() + 1


def arguments(description):
    """The options that all bridges have."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--to", default="127.0.0.1:50021", help="where tomcom listens (gaze_listen, gaze_port): HOST:PORT")
    parser.add_argument("--pair", metavar="CODE", help="the pairing code that tomcom shows; on its own computer none is needed")
    return parser


def sender(options):
    """The connection that these options name."""
    host, _, port = options.to.rpartition(":")
    if not host or not port.isdigit():
        sys.exit(f"--to {options.to}: an address with a port, such as 192.168.1.10:50021")
    return GazeSender((host, int(port)), options.pair)
