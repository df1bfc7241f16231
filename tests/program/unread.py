"""Runs a program in a terminal that somebody stops reading, asks it to end, and tells how it did, as JSON. Needs nothing but
Python's own library.

    unread.py '{"command": ["tomcom", ...], "see": "READY", "keys": ["\\u0003", "y"], "signals": ["TERM"]}'
"""

import fcntl
import json
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time

PATIENCE_S = 300
# Between two keys, so that the second is not taken for a held one.
BETWEEN_KEYS_S = 1.2
ESCAPES = re.compile(rb"\x1b(\[[0-9;:<>=?]*[ -/]*[@-~]|\][^\x1b\x07]*(\x1b\\|\x07))")
# What the program asks a terminal for: its primary device attributes.
QUESTION, ANSWER = b"\x1b[c", b"\x1b[?62;22c"


def resize(terminal, columns, rows):
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))


def read_until(master, text, process):
    """Reads along like a terminal until this stands on the screen."""
    seen, until = b"", time.monotonic() + PATIENCE_S
    # A screen is drawn word by word.
    shown = lambda: ESCAPES.sub(b"", seen).replace(b" ", b"").decode("utf-8", "replace")
    while text.replace(" ", "") not in shown():
        assert time.monotonic() < until, f"waited in vain for {text}: {shown()[-2000:]}"
        assert process.poll() is None, f"ended: {shown()[-2000:]}"
        if select.select([master], [], [], 0.1)[0]:
            news = os.read(master, 1 << 16)
            seen += news
            if QUESTION in news:
                os.write(master, ANSWER)


def fill(master, slave):
    """Lets the program draw whole screens until the terminal has no room for more."""
    until, wide = time.monotonic() + PATIENCE_S, False
    while select.select([], [slave], [], 0.5)[1]:
        assert time.monotonic() < until, "the terminal does not fill"
        wide = not wide
        resize(master, *((200, 60) if wide else (120, 40)))


def main():
    asked = json.loads(sys.argv[1])
    master, slave = pty.openpty()
    resize(master, 120, 40)
    environment = {**os.environ, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8"}
    process = subprocess.Popen(
        asked["command"], stdin=slave, stdout=slave, stderr=slave, env=environment, start_new_session=True,
        preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),
    )
    try:
        read_until(master, asked["see"], process)
        fill(master, slave)
        began = time.monotonic()
        for key in asked.get("keys", []):
            os.write(master, key.encode())
            began = time.monotonic()
            if key != asked["keys"][-1]:
                time.sleep(BETWEEN_KEYS_S)
        for name in asked.get("signals", []):
            process.send_signal(getattr(signal, f"SIG{name}"))
        try:
            code = process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            code = None
        seconds = time.monotonic() - began
        rest = b""
        while select.select([master], [], [], 0.2)[0]:
            rest += os.read(master, 1 << 16)
    finally:
        process.kill()
    # Echo and lines again, as a shell expects them; the main screen.
    modes = termios.tcgetattr(slave)[3]
    is_whole = bool(modes & termios.ECHO and modes & termios.ICANON and b"\x1b[?1049l" in rest)
    print(json.dumps({"exit": code, "seconds": seconds, "whole": is_whole, "rest": rest[-600:].decode("utf-8", "replace")}))


if __name__ == "__main__":
    main()
