"""The tags of a screenshot, as the scene camera of an eye tracker sees them, read by another program: pupil-apriltags.

    tests/outside/tags.py TOMCOM LAYOUT SCREENSHOT...
"""

import functools
import json
import subprocess
import sys

import numpy as np
from PIL import Image
from pupil_apriltags import Detector

# The display, where the person stands, and the camera: Pupil Core's scene camera at 1280 x 720.
WIDTH_M, DISTANCE_M, TURNS_DEG = 1.5, 2.0, (0, 20, 40)
CAMERA, FOCAL_PX = (1280, 720), 790.0
IDS = [0, 1, 2, 3]


def seen(screen, turn_deg, distance_m=DISTANCE_M):
    """The screen as a camera sees it that stands `turn_deg` beside its middle: a pinhole, with blur and noise."""
    height, width = screen.shape
    metre = width / WIDTH_M
    turn = np.radians(turn_deg)
    rotation = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    camera = np.array([[FOCAL_PX, 0, CAMERA[0] / 2], [0, FOCAL_PX, CAMERA[1] / 2], [0, 0, 1]])
    # A point of the screen in pixels, in metres around its middle, in front of the camera.
    to_metres = np.array([[1 / metre, 0, -width / 2 / metre], [0, 1 / metre, -height / 2 / metre], [0, 0, 1]])
    plane = np.column_stack([rotation[:, 0], rotation[:, 1], [0, 0, distance_m]])
    back = np.linalg.inv(camera @ plane @ to_metres)
    # Each pixel of the camera is the mean of what falls on it: three by three rays.
    image = np.zeros((CAMERA[1], CAMERA[0]))
    for dy in (-1 / 3, 0, 1 / 3):
        for dx in (-1 / 3, 0, 1 / 3):
            x, y = np.meshgrid(np.arange(CAMERA[0]) + dx, np.arange(CAMERA[1]) + dy)
            points = back @ np.stack([x.ravel(), y.ravel(), np.ones(x.size)])
            u, v = np.rint(points[:2] / points[2]).astype(int)
            inside = (u >= 0) & (u < width) & (v >= 0) & (v < height) & (points[2] > 0)
            ray = np.full(x.size, 70.0)
            ray[inside] = screen[v[inside], u[inside]]
            image += ray.reshape(image.shape) / 9
    noise = np.random.default_rng(1).normal(0, 4, image.shape)
    return np.clip(image * 0.8 + 20 + noise, 0, 255).astype(np.uint8)


@functools.cache
def detector():
    """One for all pictures: the library does not survive several."""
    return Detector(families="tag36h11", quad_decimate=1.0)


def check(path):
    screen = np.asarray(Image.open(path).convert("L"), dtype=float)
    for turn in TURNS_DEG:
        found = {tag.tag_id: tag for tag in detector().detect(seen(screen, turn)) if tag.decision_margin > 30}
        assert sorted(found) == IDS, f"{path} at {turn} degrees: {sorted(found)}"
        assert all(tag.hamming == 0 for tag in found.values()), f"{path} at {turn} degrees: bits are wrong"
        # Top left, top right, bottom right, bottom left.
        x, y = zip(*(found[number].center for number in IDS))
        assert x[0] < x[1] and x[3] < x[2] and y[0] < y[3] and y[1] < y[2], f"{path}: the tags are not where they belong"
        least = min(tag.decision_margin for tag in found.values())
        print(f"tags of {path.rsplit('/', 1)[-1]} at 2 m and {turn} degrees: {sorted(found)}, margin {least:.0f}")


def check_corners(tomcom, layout, path):
    """The corners of the tags are where the program says that they are."""
    done = subprocess.run([tomcom, "kitchen", layout, "--format", "json"], capture_output=True, check=True)
    told = {tag["id"]: np.array(tag["corners"]) for tag in json.loads(done.stdout)["tags"]["tags"]}
    screen = np.asarray(Image.open(path).convert("L"))
    found = {tag.tag_id: tag for tag in detector().detect(screen)}
    assert sorted(found) == sorted(told) == IDS, (sorted(found), sorted(told))
    worst = 0
    for number, corners in told.items():
        # The edge of a pixel is where its neighbour begins; the detector counts from the middle of the first.
        corners = corners * [screen.shape[1], screen.shape[0]]
        near = [min(np.linalg.norm(found[number].corners - corner, axis=1)) for corner in corners]
        worst = max(worst, *near)
        top, right = corners[1] - corners[0], corners[2] - corners[1]
        assert top[0] > 0 and abs(top[1]) < 1e-6 and right[1] > 0 and abs(right[0]) < 1e-6, "clockwise from the top left"
    assert worst < 1.5, f"a corner is {worst:.2f} pixels off"
    print(f"corners of the tags as `tomcom kitchen` prints them: at most {worst:.2f} pixels off in {path.rsplit('/', 1)[-1]}")


if __name__ == "__main__":
    program, layout_file, *screenshots = sys.argv[1:]
    for picture in screenshots:
        check(picture)
        check_corners(program, layout_file, picture)
