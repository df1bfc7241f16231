"""The arm's kinematics against Pinocchio with the UR5 of example-robot-data: the same joint angles, the same pose."""

import json
import subprocess
from importlib.metadata import files

import numpy as np
import pinocchio

# The stick on the flange, as in src/arm/ur5.urdf.
STICK_M = 0.12


def poses():
    """Joint angles and poses of the tip, as the program computes them."""
    command = ["cargo", "test", "--locked", "--test", "library", "--", "--ignored", "print_poses", "--nocapture"]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    for line in printed.splitlines():
        if line.startswith("pose "):
            joints, place, turn = (json.loads(f"[{part}") for part in line.split("[")[1:])
            yield np.array(joints), np.array(place), np.array(turn).reshape(3, 3).T


def main():
    urdf = next(file for file in files("example-robot-data") if file.name == "ur5_robot.urdf")
    model = pinocchio.buildModelFromUrdf(str(urdf.locate()))
    data = model.createData()
    flange, base = model.getFrameId("tool0"), model.getFrameId("base_link")
    away_m, away_rad, count = 0.0, 0.0, 0
    for joints, place, turn in poses():
        pinocchio.framesForwardKinematics(model, data, joints)
        tip = data.oMf[base].inverse() * data.oMf[flange] * pinocchio.SE3(np.eye(3), np.array([0.0, 0.0, STICK_M]))
        away_m = max(away_m, np.linalg.norm(tip.translation - place))
        away_rad = max(away_rad, np.linalg.norm(pinocchio.log3(tip.rotation.T @ turn)))
        count += 1
    print(f"kinematics: {count} poses of the arm, at most {away_m:.1e} m and {away_rad:.1e} rad from Pinocchio's")
    assert count == 2000, count
    assert away_m < 1e-6 and away_rad < 1e-6, (away_m, away_rad)


main()
