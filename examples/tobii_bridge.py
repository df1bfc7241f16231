"""Sends the gaze of a screen-based Tobii Pro eye tracker to tomcom.

    pip install tobii-research          # Tobii's SDK, for the versions of Python that it names
    python examples/tobii_bridge.py [--to HOST:PORT --pair CODE]

The tracker's display area is the screen on which the participant's page fills everything, and the participant is calibrated: both are
done in Tobii's Eye Tracker Manager. `tomcom --gaze json` (the default port is 50021) reads what this sends. See docs/tracker-tobii.md.
"""

import math
import queue
import statistics
import sys

from gaze_sender import arguments, sample, sender

try:
    import tobii_research
except ModuleNotFoundError:
    tobii_research = None

# Tobii's clocks count microseconds.
US_PER_S = 1e6


def line(gaze, now_us):
    """The sample for a datum of Tobii's SDK (as a dictionary), at this time of the computer's clock in the SDK.

    Points are on the display area, origin at the top left: tomcom's own. An eye that is not tracked is invalid, and its point is NaN;
    the gaze is the mean of the valid eyes. Valid is all that the SDK says of a point, so confidence is 1 or 0."""
    points = []
    for eye in ("left", "right"):
        point = gaze[f"{eye}_gaze_point_on_display_area"]
        if gaze[f"{eye}_gaze_point_validity"] == 1 and all(math.isfinite(value) for value in point):
            points.append(point)
    point = [statistics.fmean(axis) for axis in zip(*points)] if points else None
    return sample(point, gaze["device_time_stamp"] / US_PER_S, (now_us - gaze["system_time_stamp"]) / US_PER_S)


def main():
    parser = arguments(__doc__)
    parser.add_argument("--serial", help="the tracker's serial number, if there are several")
    options = parser.parse_args()
    if tobii_research is None:
        sys.exit("Tobii's SDK is missing: pip install tobii-research, with a version of Python that it names")
    found = [tracker for tracker in tobii_research.find_all_eyetrackers() if options.serial in (None, tracker.serial_number)]
    if not found:
        sys.exit("no Tobii eye tracker is found: connect it, and look for it in Eye Tracker Manager")
    tracker, tomcom, data = found[0], sender(options), queue.Queue()
    print(f"{tracker.model} {tracker.serial_number}", flush=True)
    # The SDK calls from a thread of its own, which must not wait for the network.
    tracker.subscribe_to(tobii_research.EYETRACKER_GAZE_DATA, data.put, as_dictionary=True)
    try:
        while True:
            gaze = data.get()
            tomcom.send(line(gaze, tobii_research.get_system_time_stamp()))
    except KeyboardInterrupt:
        tracker.unsubscribe_from(tobii_research.EYETRACKER_GAZE_DATA, data.put)


if __name__ == "__main__":
    main()
