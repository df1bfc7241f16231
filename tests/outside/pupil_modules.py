"""Pupil Capture without cameras and windows: Pupil's own, unmodified recorder, annotation plugin, fixation and blink detectors, Time
Sync and Pupil Remote, around stand-ins for window system, cameras, pupil detection and surface tracking.

    pupil_modules.py SOURCE PORT FOLDER [--surface NAME] [--seconds 0] [--hz 120] [--blinks 16] [--first-blink 6]
                     [--record-messages FILE] [--lab-records] [--time-sync] [--record-clock FILE]

SOURCE is a clone of github.com/pupil-labs/pupil. Recordings go to FOLDER, with a journal of what was done. Gaze and lids follow SCRIPT.
Runs until it is killed, or for some seconds.
"""

import argparse
import json
import os
import sys
import threading
import time
import types
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import MagicMock

import msgpack
import numpy as np
import packaging.version
import zmq

FPS = 30
# Places on the surface that are looked at, and for how long, in seconds: the first fixation is one of 1.94 s.
SCRIPT = [((0.2, 0.3), 1.94), ((0.7, 0.3), 0.60), ((0.5, 0.8), 0.45), ((0.1, 0.8), 1.10), ((0.9, 0.6), 0.41)]
SACCADE_S = 0.03
# Lids are closed for this long, so often.
BLINK_S, BLINK_EVERY_S = 0.2, 1.6
# The clock that Time Sync follows appears after so long, in seconds, and is then ahead by so much, in seconds: the first difference is
# one that Time Sync jumps over, the others are slewed.
MASTER_S, MASTER_AHEAD = 2, [(0, 0.050), (6, 0.058), (18, 0.049)]
# Pupil Remote is asked for the time so often.
ASK_S = 0.25


class Elements(list):
    """A menu of Pupil's window."""

    @property
    def elements(self):
        return self


def stand_ins(source):
    """Puts modules in the place of those that need a window system, a camera or a build."""
    sys.path.insert(0, str(Path(source) / "pupil_src/shared_modules"))
    for name in (
        "uvc", "pyglui", "pyglui.ui", "pyglui.cygl", "pyglui.cygl.utils", "pyglui.pyfontstash", "pyglui.pyfontstash.fontstash",
        "OpenGL", "OpenGL.GL", "OpenGL.GLU", "gl_utils", "glfw", "cv2", "rich", "rich.progress", "ndsi", "av_writer", "background_helper",
        "audio", "pyre", "video_capture", "video_capture.ndsi_backend", "gaze_mapping", "gaze_mapping.notifications",
        "pupil_recording.update",
    ):
        sys.modules[name] = MagicMock(name=name)
    sys.modules["video_capture.ndsi_backend"].NDSI_Source = type("NDSI_Source", (), {})
    sys.modules["av_writer"].NonMonotonicTimestampError = ValueError
    nothing = SimpleNamespace(file_name=lambda: "there is none", from_dict=dict)
    for name in ("CalibrationSetupNotification", "CalibrationResultNotification"):
        setattr(sys.modules["gaze_mapping.notifications"], name, nothing)
    pyre = sys.modules["pyre"]
    pyre.zhelper, pyre.Pyre, pyre.__version__ = SimpleNamespace(zthread_fork=zthread_fork), Network, "0.3.4"
    # Gone from the package since Pupil was released.
    packaging.version.LegacyVersion = packaging.version.Version


def zthread_fork(context, work, *arguments):
    """What pyre does: a thread, with a pair of sockets between it and its parent."""
    ours, theirs = context.socket(zmq.PAIR), context.socket(zmq.PAIR)
    name = f"inproc://{id(ours)}"
    ours.bind(name)
    theirs.connect(name)
    threading.Thread(target=work, args=(context, theirs, *arguments), daemon=True).start()
    return ours


class Network:
    """What pyre does for Time Sync: it finds one other clock, which serves its time on this machine."""

    since, port = None, None

    def __init__(self, name):
        self.began = time.monotonic()

    def recent_events(self):
        if self.port is None or Network.since is not None or time.monotonic() < self.began + MASTER_S:
            return []
        Network.since = time.monotonic()
        return [SimpleNamespace(type="SHOUT", peer_uuid="master", peer_name="master", msg=[b"1000.0", str(self.port).encode()])]

    def peer_address(self, uuid):
        return "tcp://127.0.0.1:1"

    def uuid(self):
        return "here"

    def join(self, group):
        pass

    leave = join

    def start(self):
        pass

    stop = start

    def shout(self, group, message):
        pass


def vector(place):
    """The direction of the gaze: the surface is 50 degrees wide."""
    return [100 * np.tan(np.radians(50 * (value - 0.5))) for value in place] + [100.0]


class Eyes:
    """Gaze and pupils between two moments, in the order of time."""

    def __init__(self, hz, blinks):
        """`blinks`: their numbers."""
        self.hz, self.blinks, self.since, self.random = hz, blinks, None, np.random.default_rng(3)
        self.period = sum(seconds + SACCADE_S for _, seconds in SCRIPT)

    def place(self, at):
        at %= self.period
        for index, (place, seconds) in enumerate(SCRIPT):
            if at < seconds:
                return np.array(place) + self.random.normal(0, 0.002, 2)
            at -= seconds
            if at < SACCADE_S:
                following = SCRIPT[(index + 1) % len(SCRIPT)][0]
                return np.array(place) + (np.array(following) - np.array(place)) * at / SACCADE_S
            at -= SACCADE_S

    def until(self, seconds, now):
        """`seconds` since the beginning; `now` in Pupil time."""
        since, self.since = self.since if self.since is not None else seconds, seconds
        ahead = now - seconds
        gaze, pupils = [], []
        for step in range(int(np.ceil(since * self.hz)), int(np.ceil(seconds * self.hz))):
            at = step / self.hz
            place = self.place(at)
            gaze.append({
                "topic": "gaze.3d.01.", "norm_pos": tuple(map(float, place)), "gaze_point_3d": [float(v) for v in vector(place)],
                "confidence": 0.97, "timestamp": at + ahead,
            })
            number = int(at // BLINK_EVERY_S)
            is_closed = number in self.blinks and at - number * BLINK_EVERY_S < BLINK_S
            for eye in (0, 1):
                confidence = 0.05 if is_closed else 0.96
                pupils.append({"topic": f"pupil.{eye}.2d", "confidence": confidence, "timestamp": at + ahead + eye * 1e-3})
        return gaze, pupils


class Capture:
    def __init__(self, arguments):
        self.arguments = arguments
        stand_ins(arguments.source)
        import annotations
        import blink_detection
        import fixation_detector
        import plugin
        import recorder
        import zmq_tools
        from network_api.controller.pupil_remote_controller import PupilRemoteController

        folder = Path(arguments.folder)
        (folder / "settings").mkdir(parents=True, exist_ok=True)
        self.journal = open(folder / "journal.jsonl", "a", buffering=1)
        context = zmq.Context.instance()
        self.urls = self.backbone(context)
        pool = self.pool = SimpleNamespace(
            app="capture", process="world", user_dir=str(folder / "settings"), version="3.6.0", zmq_ctx=context,
            timebase=SimpleNamespace(value=0.0), min_data_confidence=0.6, preferred_remote_port=arguments.port,
            ipc_pub_url=self.urls[0], ipc_sub_url=self.urls[1], ipc_push_url=self.urls[2], get_now=time.monotonic,
            menubar=MagicMock(), iconbar=MagicMock(), quickbar=Elements(), gui=MagicMock(),
            capture=SimpleNamespace(intrinsics=MagicMock(), frame_size=(1280, 720), jpeg_support=False),
        )
        pool.get_timestamp = lambda: time.monotonic() - pool.timebase.value
        pool.ipc_pub = self.ipc_pub = zmq_tools.Msg_Dispatcher(context, self.urls[2])
        self.notices = zmq_tools.Msg_Receiver(context, self.urls[1], topics=("notify",))
        classes = [recorder.Recorder, annotations.Annotation_Capture, fixation_detector.Fixation_Detector]
        classes.append(blink_detection.Blink_Detection)
        names = [("Recorder", {"record_world": False, "record_eye": False}), ("Fixation_Detector", {}), ("Blink_Detection", {})]
        if arguments.time_sync:
            names.append(("Time_Sync", {}))
            classes.append(self.time_sync())
        pool.plugin_by_name = {one.__name__: one for one in classes}
        pool.plugins = plugin.Plugin_List(pool, names)
        self.remote = PupilRemoteController(pool)
        self.eyes = Eyes(arguments.hz, range(arguments.first_blink, arguments.first_blink + arguments.blinks))
        self.messages = open(arguments.record_messages, "wb") if arguments.record_messages else None
        self.timebase = None
        if arguments.record_clock:
            threading.Thread(target=self.record_clock, daemon=True).start()

    def time_sync(self):
        """Pupil's plugin; the clock that it follows is served by Pupil's own code, too."""
        import network_time_sync
        import time_sync

        def ahead():
            seen_s = time.monotonic() - (Network.since or time.monotonic())
            return time.monotonic() + [by for since, by in MASTER_AHEAD if since <= seen_s][-1]

        Network.port = network_time_sync.Clock_Sync_Master(ahead).port
        return time_sync.Time_Sync

    def record_clock(self):
        """Asks Pupil Remote for the time as this program does: seconds when it was asked and answered, Pupil time, and Pupil's base."""
        remote = zmq.Context.instance().socket(zmq.REQ)
        remote.connect(f"tcp://127.0.0.1:{self.arguments.port}")
        began = time.monotonic()
        with open(self.arguments.record_clock, "w", buffering=1) as table:
            table.write("asked_s,answered_s,pupil_s,behind_s\n")
            while True:
                asked = time.monotonic()
                remote.send_string("t")
                answer = float(remote.recv_string())
                answered = time.monotonic()
                behind = self.pool.timebase.value - began
                table.write(f"{asked - began:.6f},{answered - began:.6f},{answer:.6f},{behind:.6f}\n")
                time.sleep(ASK_S)

    def backbone(self, context):
        xsub, xpub, pull = context.socket(zmq.XSUB), context.socket(zmq.XPUB), context.socket(zmq.PULL)
        for socket in (xsub, xpub, pull):
            socket.bind("tcp://127.0.0.1:*")
        urls = [socket.last_endpoint.decode() for socket in (xsub, xpub, pull)]
        threading.Thread(target=zmq.proxy, args=(xsub, xpub), daemon=True).start()

        def pull_pub():
            publisher = context.socket(zmq.PUB)
            publisher.connect(urls[0])
            while True:
                publisher.send_multipart(pull.recv_multipart())

        threading.Thread(target=pull_pub, daemon=True).start()
        return urls

    def note(self, what, **fields):
        self.journal.write(json.dumps({"what": what, "t": self.pool.get_timestamp(), **fields}) + "\n")

    def surface(self, gaze, fixations, now):
        """The datum of a surface that fills the scene camera's picture."""
        def on_surface(item, topic):
            kept = {key: item[key] for key in ("norm_pos", "confidence", "timestamp", "id", "duration", "dispersion") if key in item}
            return {**kept, "topic": topic, "on_surf": True, "base_data": (item["topic"], item["timestamp"])}

        same = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        name = self.arguments.surface
        return {
            "topic": f"surfaces.{name}", "name": name, "surf_to_img_trans": same, "img_to_surf_trans": same,
            "surf_to_dist_img_trans": same, "dist_img_to_surf_trans": same, "timestamp": now,
            "gaze_on_surfaces": [on_surface(item, f"{item['topic']}_on_surface") for item in gaze],
            "fixations_on_surfaces": [on_surface(item, "fixations_on_surface") for item in fixations],
        }

    def frame(self, seconds):
        pool = self.pool
        while self.notices.new_data:
            topic, notice = self.notices.recv()
            self.note("notice", subject=notice["subject"], name=notice.get("session_name", notice.get("name")))
            if notice["subject"] == "start_plugin":
                pool.plugins.add(pool.plugin_by_name[notice["name"]], args=notice.get("args", {}))
            for one in pool.plugins:
                one.on_notify(notice)
        now = pool.get_timestamp()
        if self.timebase != pool.timebase.value:
            self.timebase = pool.timebase.value
            self.note("timebase", base=self.timebase)
        gaze, pupils = self.eyes.until(seconds, now)
        events = {"dt": 1 / FPS, "gaze": gaze, "pupil": pupils}
        for one in pool.plugins:
            one.recent_events(events)
        if self.arguments.surface:
            events["surfaces"] = [self.surface(gaze, events["fixations"], now)]
        for annotation in events.pop("annotation", []):
            self.note("annotation", **annotation)
        del events["dt"], events["gaze"], events["pupil"]
        pool.plugins.clean()
        for data in events.values():
            for datum in data:
                if self.messages:
                    payload = msgpack.packb(datum, use_bin_type=True)
                    self.messages.write(msgpack.packb([seconds, datum["topic"], payload], use_bin_type=True))
                self.ipc_pub.send(datum)
                if datum["topic"] == "blinks":
                    self.note("blink", type=datum["type"])

    def run(self):
        if self.arguments.lab_records:
            self.ipc_pub.notify({"subject": "recording.should_start", "session_name": "lab"})
        began, number = time.monotonic(), 0
        self.note("began")
        while not self.arguments.seconds or number / FPS < self.arguments.seconds:
            number += 1
            time.sleep(max(0.0, began + number / FPS - time.monotonic()))
            # The script's time runs with the frames, so that two runs send the same.
            self.frame(number / FPS)
        for one in self.pool.plugins:
            one.cleanup()
        self.note("ended")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("port", type=int)
    parser.add_argument("folder")
    parser.add_argument("--surface", default="Surface 1", help="the surface that is seen; empty: none")
    parser.add_argument("--seconds", type=float, default=0)
    parser.add_argument("--hz", type=int, default=120, help="samples of gaze a second")
    parser.add_argument("--blinks", type=int, default=16)
    parser.add_argument("--first-blink", type=int, default=6, help=f"in units of {BLINK_EVERY_S} s")
    parser.add_argument("--record-messages", help="file that gets what is published, in MessagePack: [seconds, topic, payload]")
    parser.add_argument("--lab-records", action="store_true", help="a recording that the lab began runs already")
    parser.add_argument("--time-sync", action="store_true", help="Time Sync follows a clock that appears, and is set and drifts")
    parser.add_argument("--record-clock", help="file that gets Pupil Remote's answers to requests for the time, as CSV")
    Capture(parser.parse_args()).run()
    os._exit(0)
