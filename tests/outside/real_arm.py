"""A live session drives an arm, the simulated controller of a UR5: set-up with its dry run in the controller's time, presses,
faults, and its recording verifies without an arm.

    tests/outside/real_arm.py TOMCOM FOLDER
"""

import subprocess
import time

from console import Console, verify
from ur import HOST, ROOT, SCRATCH, TOMCOM, Controller, wait_until


def robot_presses(folder):
    """Number of presses of the robot in the only recording in a folder."""
    logs = list(folder.glob("*/events.jsonl"))
    return sum(line.count('"kind":"press","agent":"robot"') for line in logs[0].read_text().splitlines()) if logs else 0


def main():
    SCRATCH.mkdir(parents=True, exist_ok=True)
    controller = Controller()
    session, out = SCRATCH / "real.toml", SCRATCH / "recordings"
    settings = '[trial]\ncondition = "none"\nseconds = 900\n[assistant]\nshadow = "off"\n[robot]\n'
    session.write_text(f'layout = "{ROOT}/layouts/sushi.toml"\n{settings}arm = {{ ur = "{HOST}" }}\nspeed = 1.0\n')
    doctor = subprocess.run([TOMCOM, "doctor", session], capture_output=True, text=True, check=False)
    assert "simulated by tomcom" in doctor.stdout and "within reach" in doctor.stdout, doctor.stdout
    refused = subprocess.run([TOMCOM, "simulate", session, "--trials", "1"], capture_output=True, text=True, check=False)
    assert refused.returncode != 0 and "a real arm, in a run without a console" in refused.stderr, refused.stderr

    with Console(TOMCOM, [session, "--out", out]) as console:
        def presses(more):
            wanted = robot_presses(out) + more

            def are_made():
                # On a busy machine the heartbeat comes late, and the arm's program stops as it should.
                if "DOES NOT RUN" in console.text():
                    console.key("\x12")
                    time.sleep(1)
                return robot_presses(out) >= wanted

            wait_until(are_made, 180.0)

        console.wait_for("no power")
        console.key(".")
        console.wait_for("Checks before the trial")
        console.key("\x19")
        console.wait_for("waits for its dry run")
        console.key("\x19")
        console.wait_for("dry run done", 900)
        console.key("\x19")
        console.wait_for("arm: ready|all checks|start the trial")
        console.key("\x1b")
        wait_until(lambda: "Checks before the trial" not in console.text())
        console.start()
        presses(4)
        controller.type("protective-stop")
        console.wait_for("PROTECTIVE STOP")
        console.key("\x12")
        presses(2)
        controller.type("disconnect 1")
        console.wait_for("NO CONNECTION")
        console.wait_for("DOES NOT RUN")
        console.key("\x12")
        presses(2)
        controller.type("stop-program")
        console.wait_for("DOES NOT RUN")
        console.key("\x12")
        presses(2)
        console.key(" ")
        console.wait_for("EMERGENCY STOP")
        console.key("\x12")
        presses(1)
        console.end()
        console.quit()
    controller.end()
    recording = next(out.iterdir())
    verify(TOMCOM, recording)
    print(f"  {robot_presses(out)} presses in a session; its recording verifies")


if __name__ == "__main__":
    main()
