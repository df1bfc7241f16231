"""Films of the participant's page beside a recording: a session in Chromium is filmed, and films are made from its pictures with other
rates, codecs and mishaps; `tomcom video attach` must find where each begins, to one frame, or refuse it. The session itself films
the page, too, by a camera in the network, and attaches that film when it ends; a film in VP9 is converted.

    tests/outside/video.py TOMCOM FOLDER
"""

import base64
import hashlib
import io
import json
import re
import subprocess
import sys
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
from PIL import Image

from console import recorded, verify
from display import operate, session_file, url
from page import Page, browser

PAGE_SIZE = (640, 360)
# The camera: its picture, and where the page is in it (left, top, width, height).
SIZE, AREA, FLASH_S = (640, 360), (150, 90, 360, 202), 0.2
# Notes when the page says that it has drawn, by the clock of the computer.
NOTES = """
window.drawnAt = [];
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (text) {
  if (typeof text === "string" && text.includes('"drawn"')) window.drawnAt.push((performance.timeOrigin + performance.now()) / 1000);
  return send.call(this, text);
};
"""


class NetworkCamera:
    """A camera in the network that looks at the page: 30 pictures a second, each what the browser has drawn last."""

    def __init__(self):
        camera = self
        picture = io.BytesIO()
        Image.new("RGB", PAGE_SIZE).save(picture, "JPEG")
        self.picture = picture.getvalue()
        # How old pictures are when the camera gets them: the browser tells of them while it is listened to.
        self.late_s = []

        class Pictures(BaseHTTPRequestHandler):
            def do_GET(self):
                self.send_response(200)
                self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=picture")
                self.end_headers()
                try:
                    while True:
                        picture = camera.picture
                        self.wfile.write(b"--picture\r\nContent-Type: image/jpeg\r\nContent-Length: %d\r\n\r\n%s\r\n" % (len(picture), picture))
                        time.sleep(1 / 30)
                except OSError:
                    return

            def log_message(self, *_):
                return

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Pictures)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def device(self):
        return f"-f mpjpeg -i http://127.0.0.1:{self.server.server_address[1]}/"


def record(tomcom, chromium, folder):
    """A short trial with signals: the recording, frames of the page with their times, and pictures of it dark and lit."""
    session, camera = session_file(folder, "sushi", 9707), NetworkCamera()
    session.write_text(session.read_text() + f'[video]\ndevices = ["{camera.device()}"]\n')
    frames = []
    console = operate(tomcom, session, folder, "--condition", "wizard")
    with console:
        page = Page(chromium, url(), size=PAGE_SIZE, more=NOTES)
        devtools = page.context.new_cdp_session(page.page)

        def frame(told):
            camera.picture = base64.b64decode(told["data"])
            camera.late_s.append(time.time() - told["metadata"]["timestamp"])
            frames.append((told["metadata"]["timestamp"], camera.picture))
            devtools.send("Page.screencastFrameAck", {"sessionId": told["sessionId"]})

        def wait_for(words):
            """Frames come only while the browser is listened to."""
            while not re.search(words, console.text()):
                page.page.wait_for_timeout(30)

        page.stage("welcome")
        page.page.mouse.move(320, 170)
        page.page.wait_for_timeout(1500)
        devtools.on("Page.screencastFrame", frame)
        devtools.send("Page.startScreencast", {"format": "jpeg", "quality": 80, "everyNthFrame": 1})
        console.key("\x10")
        wait_for("ROBOT HELD")
        console.key(".")
        wait_for("Checks before the trial")
        console.key("o")
        page.stage("running")
        for pause_s in (2.3, 4.1, 3.2, 5.3):
            page.page.wait_for_timeout(1000 * pause_s)
            console.key("q" if pause_s != 4.1 else "a")
        page.page.wait_for_timeout(2000)
        page.page.wait_for_timeout(1500)
        console.key("\x05")
        wait_for("End the trial")
        console.key("y")
        page.page.wait_for_timeout(2500)
        drawn_at = page.ask("drawnAt")
        devtools.send("Page.stopScreencast")
        pictures = []
        for colour in ("", "#fff"):
            page.ask(f"document.querySelector('.flash').style.background = '{colour}'")
            pictures.append(Image.open(io.BytesIO(page.page.screenshot())).convert("L"))
        page.ask("document.querySelector('.flash').style.background = ''")
        page.close()
        console.quit()
    (recording,) = (folder / "recordings").iterdir()
    events = recorded(recording)
    drawn = [event for event in events if event["kind"] == "display" and event["what"] == "drawn"]
    cues = [event["seq"] for event in events if event["kind"] in ("trial_started", "signal_shown", "trial_ended")]
    assert [event["cue"] for event in drawn] == cues and len(cues) >= 5, (drawn, cues)
    (filmed,) = [event for event in events if event["kind"] == "film"]
    assert filmed["what"] == "began" and filmed["file"] == "film-1.mp4", filmed
    start_s = next(event["t_ns"] for event in events if event["kind"] == "trial_started") / 1e9
    frames.sort(key=lambda frame: frame[0])
    return recording, [event["at_ns"] / 1e9 for event in drawn], drawn_at, frames, pictures, start_s, (filmed["began_ns"] / 1e9, max(camera.late_s))


def attach(tomcom, recording, *arguments):
    return subprocess.run([tomcom, "video", "attach", recording, *map(str, arguments)], capture_output=True, text=True)


def attached(tomcom, recording, film, *arguments):
    done = attach(tomcom, recording, film, "--format", "json", *arguments)
    assert done.returncode == 0, (film, done.stderr)
    (found,) = json.loads(done.stdout)["films"]
    assert found["sha256"] == hashlib.sha256(Path(film).read_bytes()).hexdigest()
    return found


def film_of_screencast(frames, path, rate):
    """A film of the browser's own frames: each of its frames is what was on the screen then."""
    pictures = [np.asarray(Image.open(io.BytesIO(jpeg)).convert("L")) for _, jpeg in frames]
    height, width = pictures[0].shape
    command = ["ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "gray", "-s", f"{width}x{height}", "-framerate", f"{rate[0]}/{rate[1]}",
               "-i", "-", "-c:v", "libx264", "-preset", "veryfast", path]
    process, shown = subprocess.Popen(command, stdin=subprocess.PIPE), 0
    for number in range(int((frames[-1][0] - frames[0][0]) * rate[0] / rate[1])):
        now_s = frames[0][0] + number * rate[1] / rate[0]
        while shown + 1 < len(frames) and frames[shown + 1][0] <= now_s:
            shown += 1
        picture = pictures[shown] if pictures[shown].shape == (height, width) else pictures[0]
        process.stdin.write(picture.tobytes())
    process.stdin.close()
    assert process.wait() == 0, command


class Camera:
    """What a camera sees of the page, at a time of the session."""

    def __init__(self, pictures, drawn_s, seed, brightness=1.0, hand_at_s=None, lit=True):
        left, top, width, height = AREA
        chance = np.random.default_rng(seed)
        room = np.kron(chance.integers(30, 90, (12, 20)), np.ones((30, 32)))[: SIZE[1], : SIZE[0]].astype(np.float32)
        self.rooms = []
        for picture in pictures:
            seen = room.copy()
            seen[top : top + height, left : left + width] = np.asarray(picture.resize((width, height), Image.LANCZOS), np.float32)
            self.rooms.append(seen)
        # The square is dark, and bright when it is lit.
        self.flash = np.argwhere((self.rooms[1] - self.rooms[0] > 60) & (self.rooms[0] < 90)).mean(axis=0)
        columns, rows = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
        self.columns, self.rows = columns.astype(np.float32), rows.astype(np.float32)
        far = np.hypot(columns - self.flash[1], rows - self.flash[0]) / 150
        self.light = brightness + (1 - brightness) * np.clip(far, 0, 1)
        self.drawn_s, self.chance, self.hand_at_s, self.lit = drawn_s, chance, hand_at_s, lit
        self.noise = [chance.normal(0, 2, (SIZE[1], SIZE[0])).astype(np.float32) for _ in range(7)]

    def picture(self, session_s, number):
        is_lit = self.lit and any(drawn <= session_s < drawn + FLASH_S for drawn in self.drawn_s)
        seen = self.rooms[is_lit] * self.light
        # Somebody walks about; and for a while a hand is before the square.
        x = 320 + 280 * np.sin(session_s / 3)
        body = (np.abs(self.columns - x) < 35) & (self.rows < 85)
        seen[body] = 140 + 60 * np.sin(session_s * 4)
        if self.hand_at_s is not None and abs(session_s - self.hand_at_s) < 1.2:
            y, x = self.flash
            way = 60 * max(0.0, abs(session_s - self.hand_at_s) - 0.6) / 0.6
            seen[np.hypot(self.columns - x - way, self.rows - y - way) < 22] = 165
        seen += self.noise[number % len(self.noise)]
        return np.clip(seen, 0, 255).astype(np.uint8)


def film(path, camera, offset_s, length_s, rate=(30, 1), drift=0.0, codec=("-c:v", "libx264", "-preset", "veryfast"), more=(), after=()):
    """A film in which the session begins at `offset_s`, by a clock that goes faster by `drift`."""
    command = ["ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "gray", "-s", f"{SIZE[0]}x{SIZE[1]}",
               "-framerate", f"{rate[0]}/{rate[1]}", "-i", "-", *more, *after, *codec, path]
    process = subprocess.Popen(command, stdin=subprocess.PIPE)
    for number in range(int(length_s * rate[0] / rate[1])):
        film_s = number * rate[1] / rate[0]
        process.stdin.write(camera.picture((film_s - offset_s) / (1 + drift), number).tobytes())
    process.stdin.close()
    assert process.wait() == 0, command
    return path


def main():
    tomcom, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    with browser() as chromium:
        recording, drawn_s, drawn_at, frames, pictures, start_s, (began_s, late_s) = record(tomcom, chromium, folder)
    log = (recording / "events.jsonl").read_bytes()
    length_s = drawn_s[-1] - drawn_s[0] + 8

    def check(name, path, true_s, frame_s):
        """`true_s`: where in the film a time of the session is."""
        found = attached(tomcom, recording, path)
        told_s = [found["offset_s"] + drawn * (1 + found["drift_ppm"] / 1e6) for drawn in drawn_s]
        off_s = max(abs(told - true_s(drawn)) for told, drawn in zip(told_s, drawn_s))
        assert off_s <= frame_s, (name, off_s, found)
        print(f"{name}: {found['flashes']} of {len(drawn_s)} flashes, at most {1000 * off_s:.0f} ms off where a frame lasts "
              f"{1000 * frame_s:.0f} ms (told: residual {found['residual_ms']:.0f} ms, drift {found['drift_ppm']:.0f} ppm)", flush=True)
        return found

    # The browser's own frames, at the times at which it drew them.
    behind_s = float(np.median([at - frames[0][0] - drawn for at, drawn in zip(drawn_at, drawn_s)]))
    in_flash = [sum(drawn <= at <= drawn + FLASH_S for at, _ in frames) for drawn in drawn_at]
    is_quick = min(in_flash) >= 4

    # The session's own film, which was attached when the program ended.
    (own,) = json.loads((recording / "video.json").read_text())["films"]
    assert own["file"] == "film-1.mp4" and own["sha256"] == hashlib.sha256((recording / "film-1.mp4").read_bytes()).hexdigest(), own
    later_s = own["offset_s"] + began_s
    assert abs(later_s) < 0.5 and own["length_s"] > drawn_s[-1] - began_s, (own, began_s)
    # Where ffmpeg does not keep up with the pictures, they are old when it stamps them.
    if is_quick and late_s < 0.1 and own["frame_ms"] <= 45:
        assert own["by"] == "flashes", own
    else:
        print(f"the session's own film: this machine is too busy, pictures reach the camera up to {1000 * late_s:.0f} ms late, and "
              f"ffmpeg takes one each {own['frame_ms']:.0f} ms", flush=True)
    print(f"the session's own film, attached by {own['by']}: {own.get('flashes', 0)} of {len(drawn_s)} flashes, "
          f"{1000 * later_s:.0f} ms later than by its times", flush=True)

    rates = {"chromium.mp4": (30, 1), "chromium-ntsc.mp4": (30000, 1001)} if is_quick else {}
    if not is_quick:
        print(f"Chromium's own frames: this machine is too busy, frames in each flash: {in_flash}", flush=True)
    for name, rate in rates.items():
        film_of_screencast(frames, folder / name, rate)
        check(f"Chromium's own frames, {rate[0] / rate[1]:.2f} fps", folder / name, lambda drawn: drawn + behind_s, rate[1] / rate[0])

    before_s = 3.2 - drawn_s[0]
    usual = {"pictures": pictures, "drawn_s": drawn_s}
    made = {
        "30 fps, H.264": {},
        "29.97 fps": {"rate": (30000, 1001)},
        "a drift of 100 ppm": {"drift": 100e-6},
        "a dark corner": {"camera": {"brightness": 0.2}},
        "a hand before the flash": {"camera": {"hand_at_s": drawn_s[2] + 0.1}},
        "an audio track": {"more": ("-f", "lavfi", "-i", "sine=frequency=300", "-shortest", "-c:a", "aac")},
        "VP9": {"suffix": "webm", "codec": ("-c:v", "libvpx-vp9", "-deadline", "realtime", "-cpu-used", "8", "-b:v", "2M")},
        "MJPEG": {"suffix": "avi", "codec": ("-c:v", "mjpeg", "-q:v", "5", "-pix_fmt", "yuvj420p")},
        "a variable rate": {"rate": (60, 1), "after": ("-vf", "select=eq(n\\,0)+gt(random(0)\\,0.5)", "-fps_mode", "vfr")},
        "H.264 with B frames that begins late": {"codec": ("-c:v", "libx264", "-bf", "3", "-preset", "veryfast", "-output_ts_offset", "5")},
    }
    for number, (name, way) in enumerate(made.items()):
        way = dict(way)
        camera = Camera(seed=number, **usual, **way.pop("camera", {}))
        path = folder / f"{number}.{way.pop('suffix', 'mp4')}"
        # A camera begins anywhere between two frames of another.
        offset_s = before_s + 0.0071 * number
        film(path, camera, offset_s, length_s, **way)
        rate = way.get("rate", (30, 1))
        frame_s = rate[1] / rate[0] if "variable" not in name else 1 / 30
        check(name, path, lambda drawn, way=way, offset_s=offset_s: offset_s + drawn * (1 + way.get("drift", 0.0)), frame_s)
    assert len(json.loads((recording / "video.json").read_text())["films"]) == len(made) + len(rates) + 1, "each camera is kept"
    hidden = next(film for film in json.loads((recording / "video.json").read_text())["films"] if film["file"].endswith("/4.mp4"))
    assert hidden["flashes"] == len(drawn_s) - 1, hidden
    kept = (recording / "video.json").read_text()

    other_s = [drawn_s[0] + 1.7 * (drawn - drawn_s[0]) + 0.4 * index for index, drawn in enumerate(drawn_s)]
    refused = {
        "no flash": (Camera(seed=50, **usual, lit=False), length_s, "no flash|of which . fit the log"),
        "another trial's film": (Camera(pictures, other_s, 51), other_s[-1] - other_s[0] + 8, "fit the log"),
        "cut before the second flash": (Camera(seed=52, **usual), drawn_s[1] - drawn_s[0] + 2.5, "fit the log"),
    }
    for name, (camera, lasts_s, said) in refused.items():
        path = film(folder / f"{name.replace(' ', '-')}.mp4", camera, before_s, lasts_s)
        done = attach(tomcom, recording, path)
        message = " ".join(done.stderr.split())
        assert done.returncode == 2 and re.search(said, message), (name, done.returncode, message)
        assert (recording / "video.json").read_text() == kept, name
        print(f"refused, {name}: {message[:240]}", flush=True)
    done = attach(tomcom, recording, recording / "events.jsonl")
    assert done.returncode == 2 and "ffmpeg cannot decode it" in done.stderr, done.stderr

    # Converted, and found at the same place again.
    vp9 = next(folder.glob("*.webm"))
    done = attach(tomcom, recording, vp9, "--convert", "--format", "json")
    assert done.returncode == 0, done.stderr
    (copy,) = json.loads(done.stdout)["films"]
    assert copy["file"] == f"{vp9.stem}-h264.mp4" and copy["copies_of"] == [str(vp9.resolve())], copy
    again = attached(tomcom, recording, recording / copy["file"])
    told_s = [[found["offset_s"] + drawn * (1 + found["drift_ppm"] / 1e6) for drawn in drawn_s] for found in (copy, again)]
    off_s = max(abs(a - b) for a, b in zip(*told_s))
    assert off_s < 0.01, (copy, again)
    assert not any(film["file"] == str(vp9.resolve()) for film in json.loads((recording / "video.json").read_text())["films"])
    print(f"VP9 as H.264: {1000 * off_s:.1f} ms off the film", flush=True)

    # By hand, and copied.
    dark = folder / "no-flash.mp4"
    found = attached(tomcom, recording, dark, "--at", "3.2")
    assert found["by"] == "trial_start" and abs(found["offset_s"] - (3.2 - start_s)) < 1e-3, found
    found = attached(tomcom, recording, dark, "--offset", "-1.5", "--copy")
    assert found["by"] == "offset" and found["offset_s"] == -1.5 and found["file"] == "no-flash.mp4", found
    assert (recording / "no-flash.mp4").read_bytes() == dark.read_bytes()
    assert (recording / "events.jsonl").read_bytes() == log, "the log stays as it is"
    verify(tomcom, recording)


if __name__ == "__main__":
    main()
