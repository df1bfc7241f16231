"""Puts a Neon that is none in the place of the one that Pupil's real package would find in the network: all else of it is real. It gives
what FRAMES (a file of numpy) has, over and over: pictures of the scene camera, gaze in them, whether the glasses are worn.

The first picture is taken at NEON_BEGAN, in seconds since 1970. The phone's clock is behind this computer's by BEHIND_S, a picture arrives
LATE_S after it was taken, and whoever asks too seldom gets the newest one.
"""

import os
import time
from types import SimpleNamespace

import numpy as np

BEHIND_S, LATE_S, FPS = 4.2, 0.15, 30


class Neon:
    def __init__(self):
        from pupil_labs.neon_recording.calib import Calibration

        self.frames = np.load(os.environ["NEON_FRAMES"])
        calibration = np.zeros(1, Calibration.dtype)
        calibration["scene_camera_matrix"] = self.frames["camera"]
        calibration["scene_distortion_coefficients"] = self.frames["distortion"]
        self.calibration = Calibration.from_buffer(calibration.tobytes())
        self.began, self.number = float(os.environ["NEON_BEGAN"]), 0

    def get_calibration(self):
        return self.calibration

    def estimate_time_offset(self, number_of_measurements=100):
        from pupil_labs.realtime_api.time_echo import Estimate, TimeEchoEstimates

        # Measured in whole milliseconds.
        offset = [round(BEHIND_S * 1000) + step for step in (0, 1, 0, -1, 0)][:number_of_measurements]
        return TimeEchoEstimates(Estimate([3] * len(offset)), Estimate(offset))

    def receive_matched_scene_video_frame_and_gaze(self, timeout_seconds=None):
        from pupil_labs.realtime_api.simple import MatchedItem, SimpleVideoFrame
        from pupil_labs.realtime_api.streaming.gaze import GazeData

        newest = int((time.time() - LATE_S - self.began) * FPS)
        self.number = max(self.number + 1, newest)
        taken = self.began + self.number / FPS
        time.sleep(max(0.0, taken + LATE_S - time.time()))
        index = self.number // FPS % len(self.frames["gaze"])
        stamp = taken - BEHIND_S
        x, y = self.frames["gaze"][index]
        gaze = GazeData(float(x), float(y), bool(self.frames["worn"][index]), stamp)
        return MatchedItem(SimpleVideoFrame(self.frames["pictures"][self.frames["picture"][index]], stamp), gaze)

    def close(self):
        pass


if "NEON_FRAMES" in os.environ:
    from pupil_labs.realtime_api import simple

    simple.discover_one_device = lambda max_search_duration_seconds=10.0: Neon()
    simple.Device = SimpleNamespace
