"""Runs a program whose output goes to another terminal than its input comes from, closes the terminal of the output, and
tells how the program ends, as JSON. The program then cannot find out how large its terminal is, so its next frame fails.
Needs nothing but Python's own library.

    hung_up.py '{"command": ["tomcom", ...], "see": "READY"}'
"""

import json
import os
import pty
import select
import subprocess
import sys
import time

# What is compiled would be left among the tests.
sys.dont_write_bytecode = True
from unread import PATIENCE_S, read_until, resize


def main():
    asked = json.loads(sys.argv[1])
    (keys, stdin), (screen, stdout) = pty.openpty(), pty.openpty()
    resize(screen, 120, 40)
    # Without a terminal that controls it, the program asks its output; without PATH it finds no other program to ask.
    environment = {**os.environ, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8", "PATH": "/nonexistent"}
    process = subprocess.Popen(
        asked["command"], stdin=stdin, stdout=stdout, stderr=subprocess.PIPE, env=environment, start_new_session=True,
    )
    try:
        read_until(screen, asked["see"], process)
        # The rest of the frame: where its writing fails, the program takes the terminal for closed, and draws no other.
        while select.select([screen], [], [], 0.1)[0]:
            os.read(screen, 1 << 16)
        os.close(stdout)
        os.close(screen)
        began = time.monotonic()
        told = process.communicate(timeout=PATIENCE_S)[1].decode("utf-8", "replace")
    finally:
        process.kill()
    os.close(keys)
    print(json.dumps({"exit": process.returncode, "seconds": time.monotonic() - began, "told": told[-600:]}))


main()
