"""A Tobii that is none: the calls and the data of Tobii's SDK (Tobii Pro SDK, Python reference: GazeData), with gaze that goes around in a
circle. Eyes are lost at times, one or both; a lost eye is invalid, and its point is NaN. The tracker's clock is none of this computer's."""

import math
import threading
import time

EYETRACKER_GAZE_DATA = "eyetracker_gaze_data"
HZ, LATE_S, DEVICE_US = 120, 0.008, 987_654_321
NAN = (float("nan"), float("nan"))


def get_system_time_stamp():
    """The computer's clock in the SDK, in microseconds."""
    return time.monotonic_ns() // 1000


def datum(index, taken_us):
    """The nth datum: the left eye is 2 % too far left, the right one as much too far right."""
    angle = 2 * math.pi * index / HZ
    x, y = 0.5 + 0.3 * math.cos(angle), 0.5 + 0.25 * math.sin(angle)
    # In every second both eyes are there, then the right one, the left one, and none.
    part = index % HZ // (HZ // 4)
    validity = {"left": part in (0, 2), "right": part in (0, 1)}
    found = {"device_time_stamp": taken_us + DEVICE_US, "system_time_stamp": taken_us}
    for eye, aside in (("left", -0.02), ("right", 0.02)):
        is_valid = validity[eye]
        found |= {
            f"{eye}_gaze_point_on_display_area": (x + aside, y) if is_valid else NAN,
            f"{eye}_gaze_point_in_user_coordinate_system": (12.0, 90.0, 5.0) if is_valid else NAN + NAN[:1],
            f"{eye}_gaze_point_validity": int(is_valid),
            f"{eye}_pupil_diameter": 3.4 if is_valid else float("nan"),
            f"{eye}_pupil_validity": int(is_valid),
        }
    return found


class EyeTracker:
    address, model, device_name, serial_number = "tet-tcp://127.0.0.1", "Tobii Pro Nothing", "", "TPN-000"

    def subscribe_to(self, subscription_type, callback, as_dictionary=False):
        assert subscription_type == EYETRACKER_GAZE_DATA and as_dictionary
        threading.Thread(target=self.send, args=(callback,), daemon=True).start()

    def unsubscribe_from(self, subscription_type, callback=None):
        pass

    def send(self, callback):
        began, index = time.monotonic(), 0
        while True:
            taken = began + index / HZ
            time.sleep(max(0.0, taken + LATE_S - time.monotonic()))
            callback(datum(index, int(taken * 1e6)))
            index += 1


def find_all_eyetrackers():
    return (EyeTracker(),)
