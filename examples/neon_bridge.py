"""Sends the gaze of a Pupil Neon to tomcom, mapped to the wall display by its tags.

    pip install pupil-labs-realtime-api real-time-screen-gaze
    python examples/neon_bridge.py layouts/sushi.toml [--to HOST:PORT --pair CODE]

The phone with the Companion app and this computer are in one network. `tomcom --gaze json` (the default port is 50021) reads what this
sends. See docs/tracker-neon.md.
"""

import json
import statistics
import subprocess
import sys
import threading
import time

from gaze_sender import arguments, sample, sender

try:
    from pupil_labs.real_time_screen_gaze.gaze_mapper import GazeMapper
    from pupil_labs.realtime_api.simple import Device, discover_one_device
except ModuleNotFoundError as missing:
    sys.exit(f"{missing.name} is not installed: pip install pupil-labs-realtime-api real-time-screen-gaze")

# The phone's clock is compared with this computer's so often, in seconds, and each time so often in a row.
COMPARE_S, COMPARISONS = 1.0, 5


def tag_corners(kitchen):
    """Of each tag the corners of its black square in fractions of the display, clockwise from the top left, as
    `tomcom kitchen LAYOUT --format json` prints them."""
    return {tag["id"]: [tuple(corner) for corner in tag["corners"]] for tag in kitchen["tags"]["tags"]}


class DisplayMapper:
    """Maps gaze in the scene camera's picture to the display."""

    def __init__(self, calibration, corners):
        self.mapper = GazeMapper(calibration)
        # Fractions of the display, so its size is one.
        self.display = self.mapper.add_surface(corners, (1.0, 1.0), name="wall")

    def point(self, frame, gaze):
        """The gaze on the display, origin at the top left; None where the tags are not seen or the glasses are not worn."""
        if not gaze.worn:
            return None
        found = self.mapper.process_frame(frame, gaze).mapped_gaze[self.display.uid]
        # A surface has its origin at the bottom left.
        return (found[0].x, 1.0 - found[0].y) if found else None


class PhoneClock(threading.Thread):
    """By how much this computer's clock is ahead of the phone's, compared again and again: either may be set."""

    def __init__(self, device):
        super().__init__(daemon=True)
        self.device, self.ahead_s = device, None

    def run(self):
        while True:
            found = self.device.estimate_time_offset(number_of_measurements=COMPARISONS)
            if found is not None:
                self.ahead_s = statistics.median(found.time_offset_ms.measurements) / 1000
            time.sleep(COMPARE_S)

    def age(self, phone_s, now_s):
        """Seconds since the phone's clock was at `phone_s`; None while the clocks have not been compared."""
        return None if self.ahead_s is None else now_s - (phone_s + self.ahead_s)


def kitchen_of(options):
    """What tomcom tells of the layout: asked of the program, or read from a file with its answer."""
    if options.layout.endswith(".json"):
        with open(options.layout, encoding="utf-8") as answer:
            return json.load(answer)
    command = [options.tomcom, "kitchen", options.layout, "--format", "json"]
    try:
        asked = subprocess.run(command, capture_output=True, text=True)
    except FileNotFoundError:
        sys.exit(f"no program {options.tomcom}: say where it is with --tomcom, or give the .json file that it printed")
    if asked.returncode != 0:
        sys.exit(asked.stderr)
    return json.loads(asked.stdout)


def main():
    parser = arguments(__doc__)
    parser.add_argument("layout", help="the layout that the session uses; or a .json file with what tomcom kitchen printed of it")
    parser.add_argument("--tomcom", default="tomcom", help="the program, if it is not found by its name")
    parser.add_argument("--device", metavar="ADDRESS", help="the phone's address, where the network does not tell it")
    options = parser.parse_args()
    corners = tag_corners(kitchen_of(options))
    try:
        device = Device(options.device, 8080) if options.device else discover_one_device(max_search_duration_seconds=10)
    except Exception as reason:  # aiohttp's, which the package passes on
        sys.exit(f"no Neon at {options.device}: {reason}; the Companion app shows the address under Streaming")
    if device is None:
        sys.exit("no Neon in this network: start the Companion app, or give the address that it shows under Streaming as --device")
    mapper, clock, tomcom = DisplayMapper(device.get_calibration(), corners), PhoneClock(device), sender(options)
    clock.start()
    try:
        while True:
            matched = device.receive_matched_scene_video_frame_and_gaze(timeout_seconds=1)
            if matched is not None:
                point = mapper.point(matched.frame, matched.gaze)
                taken_s = matched.gaze.timestamp_unix_seconds
                tomcom.send(sample(point, taken_s, clock.age(taken_s, time.time())))
    except KeyboardInterrupt:
        device.close()


if __name__ == "__main__":
    main()
