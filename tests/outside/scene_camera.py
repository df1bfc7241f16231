"""What a scene camera sees of the wall display and its tags: a picture drawn from what `tomcom kitchen LAYOUT --format json` prints,
through a lens with the distortion of Neon's scene camera; and where a point of the display is in that picture."""

import cv2
import numpy as np

# The display: pixels, and metres.
SCREEN, WIDTH_M, HEIGHT_M = (1920, 1080), 1.5, 1.5 * 9 / 16
# Neon's scene camera: size, focal lengths and centre of its picture, and an eight-parameter distortion.
SIZE = (1600, 1200)
CAMERA = np.array([[891.6, 0.0, 788.0], [0.0, 890.9, 593.6], [0.0, 0.0, 1.0]])
DISTORTION = np.array([-0.1308, 0.1091, 0.0004, -0.0002, 0.0012, 0.1704, 0.0524, 0.0217])


def screen(kitchen):
    """The display as a grey picture: tags on white, grey elsewhere."""
    picture = np.full((SCREEN[1], SCREEN[0]), 90.0)
    for tag in kitchen["tags"]["tags"]:
        corners = np.array(tag["corners"]) * SCREEN
        size = len(tag["cells"])
        # Cells 1 to 8 of 0 to 9 are between the corners.
        edge = (corners[2] - corners[0]) / (size - 2)
        left, top = corners[0] - edge
        for row, cells in enumerate(tag["cells"]):
            for column, cell in enumerate(cells):
                x, y = np.rint([left + column * edge[0], top + row * edge[1]]).astype(int)
                to_x, to_y = np.rint([left + (column + 1) * edge[0], top + (row + 1) * edge[1]]).astype(int)
                picture[max(y, 0) : to_y, max(x, 0) : to_x] = 10.0 if cell == "#" else 245.0
    return picture


class Pose:
    """How the display lies before the camera: turned about the vertical and the horizontal, and rolled, in degrees."""

    def __init__(self, turn, pitch, roll, distance_m, aside_m=(0.0, 0.0)):
        turn, pitch, roll = np.radians([turn, pitch, roll])
        about_y = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
        about_x = np.array([[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]])
        about_z = np.array([[np.cos(roll), -np.sin(roll), 0], [np.sin(roll), np.cos(roll), 0], [0, 0, 1]])
        self.rotation = about_z @ about_x @ about_y
        self.shift = np.array([*aside_m, distance_m])

    def in_picture(self, points):
        """Pixels in the picture of points of the display, in fractions from the top left."""
        metres = (np.atleast_2d(points) - 0.5) * [WIDTH_M, HEIGHT_M]
        corners = np.column_stack([metres, np.zeros(len(metres))])
        found, _ = cv2.projectPoints(corners, cv2.Rodrigues(self.rotation)[0], self.shift, CAMERA, DISTORTION)
        return found.reshape(-1, 2)

    def picture(self, display, seed):
        """What the camera sees: colours are grey, with blur and noise."""
        plane = CAMERA @ np.column_stack([self.rotation[:, 0], self.rotation[:, 1], self.shift])
        to_metres = np.array([
            [WIDTH_M / SCREEN[0], 0, -WIDTH_M / 2], [0, HEIGHT_M / SCREEN[1], -HEIGHT_M / 2], [0, 0, 1],
        ])
        back = np.linalg.inv(plane @ to_metres)
        image = np.zeros(SIZE[::-1])
        columns, rows = np.meshgrid(np.arange(SIZE[0], dtype=float), np.arange(SIZE[1], dtype=float))
        # Each pixel is the mean of what falls on it: three by three rays, bent as the lens bends them.
        for dy in (-1 / 3, 0, 1 / 3):
            for dx in (-1 / 3, 0, 1 / 3):
                bent = np.stack([columns.ravel() + dx, rows.ravel() + dy], axis=1)
                straight = cv2.undistortPoints(bent.reshape(-1, 1, 2), CAMERA, DISTORTION, P=CAMERA).reshape(-1, 2)
                points = back @ np.column_stack([straight, np.ones(len(straight))]).T
                x, y = (points[:2] / points[2]).astype(int)
                inside = (x >= 0) & (x < SCREEN[0]) & (y >= 0) & (y < SCREEN[1]) & (points[2] > 0)
                ray = np.full(len(straight), 60.0)
                ray[inside] = display[y[inside], x[inside]]
                image += ray.reshape(image.shape) / 9
        image = cv2.GaussianBlur(image, (0, 0), 0.7)
        image = image * 0.8 + 20 + np.random.default_rng(seed).normal(0, 3, image.shape)
        return np.repeat(np.clip(image, 0, 255).astype(np.uint8)[:, :, None], 3, axis=2)
