"""The simulated controller of a UR5 against clients of other people: PyPI's ur-rtde and universal-robots-clients, and
Universal Robots' own RTDE client for Python.

    tests/outside/ur.py TOMCOM FOLDER [CLIENT]

CLIENT is a clone of github.com/UniversalRobots/RTDE_Python_Client_Library; without it the last check is left out.
The controller has the ports of a real one, at an address of its own of this machine.
"""

import re
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import dashboard_client
import rtde_io
import rtde_receive
import script_client
from universal_robots_clients import dashboard_client as dashboard
from universal_robots_clients import rtde_client as registers

TOMCOM, SCRATCH = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
CLIENT = Path(sys.argv[3]).resolve() if len(sys.argv) > 3 else None
ROOT = Path(__file__).parents[2]
HOST = "127.0.62.1"
LONG_S = 60.0


class Controller:
    """The served controller, its buttons, and what it tells."""

    def __init__(self, *options):
        command = [TOMCOM, "arm", "--serve", "--listen", HOST, "--program", ROOT / "examples/ur_press.script", *options]
        self.process = subprocess.Popen(
            [str(part) for part in command],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.buttons = []
        threading.Thread(target=self.read, daemon=True).start()
        wait_until(lambda: len(self.buttons) > 3 and is_open(29999))

    def read(self):
        for line in self.process.stdout:
            if re.match(r" *\d+ ", line):
                self.buttons.append([float(part) for part in line.split()[1:4]])

    def type(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def end(self):
        self.process.terminate()
        assert self.process.wait(LONG_S) == 0


def is_open(port):
    with socket.socket() as probe:
        return probe.connect_ex((HOST, port)) == 0


def wait_until(true, seconds=LONG_S):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "it does not come about"
        time.sleep(0.02)


def check_dashboard():
    """ur-rtde's dashboard client and universal-robots-clients': power, brakes, programs."""
    client = dashboard_client.DashboardClient(HOST)
    client.connect()
    assert client.robotmode() == "Robotmode: POWER_OFF"
    assert client.polyscopeVersion().startswith("5.11")
    assert client.getSerialNumber().startswith("20")
    assert client.getRobotModel() == "UR5"
    assert client.isInRemoteControl()
    client.powerOn()
    wait_until(lambda: client.robotmode() == "Robotmode: IDLE")
    client.brakeRelease()
    wait_until(lambda: client.robotmode() == "Robotmode: RUNNING")
    assert client.safetystatus() == "Safetystatus: NORMAL"
    client.loadURP("ur_press.urp")
    assert "ur_press" in client.getLoadedProgram()
    assert not client.running()
    assert dashboard.get_program_state(HOST).startswith("STOPPED")
    assert dashboard.load_program(HOST, "nothing.urp") == "File not found: nothing.urp"
    assert "could not understand" in dashboard.send_command(HOST, "what is this")
    return client


def check_receive(series_hertz):
    """ur-rtde's receiver with all of its variables, at the highest frequency."""
    receive = rtde_receive.RTDEReceiveInterface(HOST, series_hertz)
    assert receive.getRobotMode() == 7 and receive.getSafetyMode() == 1 and receive.getRuntimeState() == 1
    joints, pose = receive.getActualQ(), receive.getActualTCPPose()
    assert len(joints) == 6 and all(abs(angle) < 3.2 for angle in joints), joints
    assert abs(pose[0]) < 0.9 and 0.05 < pose[2] < 0.4, pose
    assert not receive.isProtectiveStopped() and not receive.isEmergencyStopped()
    begun = receive.getTimestamp()
    time.sleep(2.0)
    passed = receive.getTimestamp() - begun
    assert 1.0 < passed < 3.0, passed
    return receive


def check_io(receive):
    """ur-rtde's inputs: slider, outputs, registers."""
    io = rtde_io.RTDEIOInterface(HOST)
    assert io.setStandardDigitalOut(3, True) and io.setSpeedSlider(0.5)
    wait_until(lambda: receive.getDigitalOutState(3) and abs(receive.getTargetSpeedFraction() - 0.5) < 1e-9)
    assert io.setStandardDigitalOut(3, False) and io.setSpeedSlider(1.0) and io.setAnalogOutputVoltage(0, 0.25)
    wait_until(lambda: not receive.getDigitalOutState(3) and receive.getStandardAnalogOutput0() > 0)
    io.disconnect()


def check_script(receive):
    """ur-rtde's script client: a motion to a place."""
    client = script_client.ScriptClient(HOST, 5, 11)
    client.connect()
    script = SCRATCH / "move.script"
    script.write_text("def move():\n  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.2\n  movej(q, a=1.0, v=0.5)\nend\n")
    before = receive.getActualQ()
    assert client.sendScript(str(script))
    wait_until(lambda: abs(receive.getActualQ()[0] - before[0] - 0.2) < 1e-3)
    wait_until(lambda: receive.getRuntimeState() == 1)
    assert max(abs(receive.getActualQ()[joint] - before[joint]) for joint in range(1, 6)) < 1e-3


class Legs:
    """Universal Robots' RTDE client, which sends legs of a way to the program of tomcom's driver."""

    INPUTS = [f"input_int_register_{at}" for at in range(24, 30)] + [f"input_double_register_{at}" for at in range(24, 48)]
    OUTPUTS = ["output_int_register_24", "output_int_register_25", "runtime_state", "safety_status_bits", "actual_q", "actual_qd"]

    def __init__(self):
        from rtde.rtde import RTDE  # noqa: PLC0415

        self.rtde = RTDE(HOST)
        self.rtde.connect()
        assert self.rtde.get_controller_version()[:2] == (5, 11)
        kinds = ["INT32", "INT32", "UINT32", "UINT32", "VECTOR6D", "VECTOR6D"]
        assert self.rtde.send_output_setup(self.OUTPUTS, kinds, frequency=125)
        self.inputs = self.rtde.send_input_setup(self.INPUTS, ["INT32"] * 6 + ["DOUBLE"] * 24)
        assert self.inputs is not None and self.rtde.send_start()
        self.beat, self.leg, self.poses = 0, 0, [0.0] * 24

    def turn(self, joints, angle):
        """A leg that turns the first joint by this angle, in radians."""
        self.leg += 1
        self.poses = [place for part in range(4) for place in [joints[0] + angle * part / 3, *joints[1:]]]

    def exchange(self):
        self.beat += 1
        values = [self.beat, self.leg, 0, 1500, 1000, -1, *self.poses]
        for name, value in zip(self.INPUTS, values, strict=True):
            setattr(self.inputs, name, value)
        self.rtde.send(self.inputs)
        state = self.rtde.receive()
        assert state is not None
        return state

    def until(self, true, seconds=LONG_S):
        end = time.monotonic() + seconds
        while not true(state := self.exchange()):
            assert time.monotonic() < end, vars(state)
        return state


def check_legs(client):
    """The driver's program follows legs, also of another client; it stops when its client is gone, and comes back."""
    legs = Legs()
    begun = legs.until(lambda state: state.runtime_state == 1)
    client.play()
    legs.until(lambda state: state.runtime_state == 2)
    for angle in (0.3, -0.3):
        before = legs.exchange()
        legs.turn(before.actual_q, angle)
        state = legs.until(lambda state: state.output_int_register_24 == legs.leg)
        assert state.output_int_register_25 == 0, vars(state)
        assert abs(state.actual_q[0] - before.actual_q[0] - angle) < 0.01, (begun.actual_q, vars(state))
    # A leg that begins elsewhere is refused.
    legs.turn([angle + 0.1 for angle in state.actual_q], 0.3)
    state = legs.until(lambda state: state.output_int_register_24 == legs.leg)
    assert state.output_int_register_25 == 4, vars(state)

    # The heartbeat ends in motion: the program stops by itself.
    legs.turn(state.actual_q, 0.3)
    legs.until(lambda state: max(abs(speed) for speed in state.actual_qd) > 0.2)
    legs.rtde.disconnect()
    wait_until(lambda: not client.running())
    again = Legs()
    state = again.until(lambda state: max(abs(speed) for speed in state.actual_qd) < 1e-3)
    assert state.runtime_state == 1
    again.rtde.disconnect()


def check_registers():
    """universal-robots-clients: state and registers through ur-rtde."""
    client = registers.connect(HOST)
    assert registers.read_robot_mode(client=client) == 7
    assert not registers.is_protective_stopped(client=client)
    registers.write_speed_slider_percent(40.0, client=client)
    wait_until(lambda: abs(registers.read_speed_slider_percent(client=client) - 40.0) < 1e-6)
    registers.write_input_int_register(42, 7, client=client)
    registers.write_tool_digital_output(1, True, client=client)
    wait_until(lambda: registers.read_tool_digital_output(1, client=client))
    registers.disconnect(client)


def running_or_none(host):
    try:
        return dashboard.send_command(host, "running")
    except OSError:
        return None


def main():
    SCRATCH.mkdir(parents=True, exist_ok=True)
    controller = Controller()
    client = check_dashboard()
    print("dashboard: ur-rtde, universal-robots-clients")
    receive = check_receive(500.0)
    print("RTDE outputs: ur-rtde")
    check_io(receive)
    print("RTDE inputs: ur-rtde")
    check_script(receive)
    print("scripts: ur-rtde")
    receive.disconnect()
    check_registers()
    print("registers: universal-robots-clients")
    if CLIENT is None:
        print("LEFT OUT: Universal Robots' own client, of which no clone was named")
    else:
        sys.path.insert(0, str(CLIENT))
        check_legs(client)
        print("legs: Universal Robots' own client")
    controller.end()

    old = Controller("--series", "cb3")
    older = dashboard_client.DashboardClient(HOST)
    older.connect()
    assert older.polyscopeVersion().startswith("3.15")
    older.brakeRelease()
    wait_until(lambda: older.robotmode() == "Robotmode: RUNNING")
    rtde_receive.RTDEReceiveInterface(HOST).disconnect()
    print("PolyScope 3: ur-rtde")
    old.end()


if __name__ == "__main__":
    main()
