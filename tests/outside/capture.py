"""A stand-in for Pupil Capture: Pupil Remote (REP) and the backbone (XSUB/XPUB) with the framing of the real one, and gaze
on a surface. It runs until it is killed.

    capture.py PORT JOURNAL --surface X0 Y0 X1 Y1 [--points X,Y ...] [--fps 30] [--samples 8] [--seconds 0] [--wild]

Points are on the display, in fractions from the top left; the surface spans the display from X0, Y0 to X1, Y1. The journal
gets a line for every request, annotation and sample, as JSON.
"""

import argparse
import json
import random
import time

import msgpack
import zmq

NAME = "wall"
# Pupil time is no clock of ours.
AHEAD_S = 1234.5
# Each point is looked at so long, in seconds.
DWELL_S = 0.4


def pupil_time():
    return time.monotonic() + AHEAD_S


class Capture:
    def __init__(self, arguments):
        self.arguments = arguments
        self.journal = open(arguments.journal, "a", buffering=1)
        context = zmq.Context()
        self.remote = context.socket(zmq.REP)
        self.remote.setsockopt(zmq.LINGER, 0)
        self.remote.bind(f"tcp://127.0.0.1:{arguments.port}")
        self.xsub, self.xpub = context.socket(zmq.XSUB), context.socket(zmq.XPUB)
        self.sub_port = self.xpub.bind_to_random_port("tcp://127.0.0.1")
        self.pub_port = self.xsub.bind_to_random_port("tcp://127.0.0.1")
        for socket in (self.xsub, self.xpub):
            socket.setsockopt(zmq.RCVHWM, 0)
            socket.setsockopt(zmq.SNDHWM, 0)
        # Capture's own processes publish as any other program does.
        self.publisher = context.socket(zmq.PUB)
        self.publisher.setsockopt(zmq.SNDHWM, 0)
        self.publisher.connect(f"tcp://127.0.0.1:{self.pub_port}")
        self.poller = zmq.Poller()
        for socket in (self.remote, self.xsub, self.xpub):
            self.poller.register(socket, zmq.POLLIN)
        self.subscribed_at = None
        # What is due later: time, and what to do then.
        self.later = []
        self.chance = random.Random(7)

    def note(self, what, **fields):
        self.journal.write(json.dumps({"what": what, **fields}) + "\n")

    def answer(self):
        first, *rest = self.remote.recv_multipart()
        request = first.decode()
        if request != "t":
            self.note("request", request=request, payload=msgpack.unpackb(rest[0]) if rest else None)
        answers = {
            "SUB_PORT": str(self.sub_port), "PUB_PORT": str(self.pub_port), "t": repr(pupil_time()), "v": "3.5.1",
        }
        known = request[:1] in "RrCc" or request.startswith("notify.")
        # Capture answers first, and does it with one of its next frames; its annotation plugin then subscribes to the backbone.
        if request == "notify.start_plugin":
            self.soon(lambda: self.xsub.send(b"\x01annotation"))
        elif request[:1] == "R":
            self.soon(lambda: self.notify("recording.started", session_name=request[2:]))
        elif request[:1] == "r":
            self.soon(lambda: self.notify("recording.stopped"))
        self.remote.send_string(answers.get(request, "OK" if known else "Unknown command."))

    def soon(self, work):
        self.later.append((time.monotonic() + 0.05, work))

    def notify(self, subject, **fields):
        self.publish(f"notify.{subject}", msgpack.packb({"subject": subject, "topic": f"notify.{subject}", **fields}))

    def forward(self, seconds):
        """The proxy between publishers and subscribers, and the answers of Pupil Remote."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0:
            while self.later and self.later[0][0] <= time.monotonic():
                self.later.pop(0)[1]()
            ready = dict(self.poller.poll(max(1, int(1000 * left))))
            if self.remote in ready:
                self.answer()
            if self.xsub in ready:
                message = self.xsub.recv_multipart()
                if message[0] == b"annotation":
                    self.note("annotation", **msgpack.unpackb(message[1]))
                self.xpub.send_multipart(message)
            if self.xpub in ready:
                subscription = self.xpub.recv()
                self.xsub.send(subscription)
                self.note("subscription", topic=subscription[1:].decode())
                if subscription == b"\x01blinks":
                    self.subscribed_at = time.monotonic()

    def publish(self, topic, payload):
        # With the further frames that some of Capture's messages have.
        self.publisher.send_multipart([topic.encode(), payload])

    def norm_pos(self, point):
        x0, y0, x1, y1 = self.arguments.surface
        return [(point[0] - x0) / (x1 - x0), 1 - (point[1] - y0) / (y1 - y0)]

    def frame(self, number, began):
        """A datum of a scene frame: the samples that were taken since the last one."""
        step_s = 1 / (self.arguments.fps * self.arguments.samples)
        items = []
        now = pupil_time()
        for index in range(self.arguments.samples):
            taken = now - (self.arguments.samples - 1 - index) * step_s
            points = self.arguments.points
            point = points[int((taken - AHEAD_S - began) / DWELL_S) % len(points)]
            items.append({
                "topic": "gaze.3d.01._on_surface", "norm_pos": self.norm_pos(point), "confidence": 0.97,
                "on_surf": True, "base_data": ["gaze.3d.01.", taken], "timestamp": taken,
            })
        place = int((now - AHEAD_S - began) / DWELL_S)
        fixation = {
            "topic": "fixations_on_surface", "norm_pos": self.norm_pos(self.arguments.points[place % len(self.arguments.points)]),
            "confidence": 0.9, "on_surf": True, "base_data": ["fixations", now], "id": place,
            "timestamp": AHEAD_S + began + place * DWELL_S, "duration": 1000 * (now - AHEAD_S - began - place * DWELL_S),
            "dispersion": 0.8,
        }
        trans = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        datum = {
            "topic": f"surfaces.{NAME}", "name": NAME, "surf_to_img_trans": trans, "img_to_surf_trans": trans,
            "surf_to_dist_img_trans": trans, "dist_img_to_surf_trans": trans, "gaze_on_surfaces": items,
            "fixations_on_surfaces": [fixation], "timestamp": now,
        }
        sent = pupil_time()
        self.publish(f"surfaces.{NAME}", msgpack.packb(datum, use_bin_type=True))
        for item, index in zip(items, range(len(items))):
            point = item["norm_pos"]
            self.note("sample", t=item["timestamp"], norm_pos=point, sent=sent)
        if self.arguments.wild:
            self.wild(datum)
        if number % (4 * self.arguments.fps) == 0:
            for offset, kind in enumerate(("onset", "offset")):
                blink = {"topic": "blinks", "type": kind, "confidence": 0.8, "timestamp": now + 0.1 * offset, "record": True}
                self.publish("blinks", msgpack.packb(blink))
                self.note("blink", type=kind)

    def wild(self, datum):
        """What real and broken streams hold besides: other surfaces, rubbish, numbers that are none, old samples again."""
        items = datum["gaze_on_surfaces"]
        nan = {**items[0], "norm_pos": [float("nan"), 0.5], "timestamp": items[0]["timestamp"] + 1e-4}
        late = {**items[0], "norm_pos": [0.5, 0.5], "timestamp": items[0]["timestamp"] - 0.08}
        old = {**items[0], "norm_pos": [0.4, 0.5], "timestamp": items[0]["timestamp"] - 9.0}
        for extra in ([nan], [items[0]], [late], [old], ["no map"], "no list"):
            self.publish(f"surfaces.{NAME}", msgpack.packb({**datum, "gaze_on_surfaces": extra, "fixations_on_surfaces": []}))
        whole = msgpack.packb(datum)
        self.publish(f"surfaces.{NAME}", whole[: self.chance.randrange(1, len(whole))])
        self.publish(f"surfaces.{NAME}", self.chance.randbytes(50))
        self.publish(f"surfaces.{NAME}2", whole)

    def run(self):
        while self.subscribed_at is None:
            self.forward(0.05)
        # Subscriptions reach the publisher a moment later.
        self.forward(0.3)
        began, number = time.monotonic(), 0
        self.note("began", t=pupil_time())
        while not self.arguments.seconds or time.monotonic() < began + self.arguments.seconds:
            self.frame(number, began)
            number += 1
            self.forward(max(0.0005, began + number / self.arguments.fps - time.monotonic()))
        self.note("ended", t=pupil_time())
        while True:
            self.forward(1)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port", type=int)
    parser.add_argument("journal")
    parser.add_argument("--surface", type=float, nargs=4, required=True)
    parser.add_argument("--points", nargs="+", type=lambda text: [float(part) for part in text.split(",")], default=[[0.5, 0.5]])
    parser.add_argument("--fps", type=int, default=30)
    parser.add_argument("--samples", type=int, default=8)
    parser.add_argument("--seconds", type=float, default=0)
    parser.add_argument("--wild", action="store_true")
    Capture(parser.parse_args()).run()
