"""A session in real time for a long while: memory and the latency of keys, minute by minute, must stay flat.

    tests/outside/endurance.py TOMCOM FOLDER --minutes 120
"""

import os
import time

from console import parser, percentile
from latency import SIGNALS, begin, send

# Memory in the last quarter over that in the second: the first is for what fills up once.
FLAT = 0.10


def run(tomcom, folder, minutes, gap_s):
    console, log = begin(tomcom, folder, 0)
    keys = list(SIGNALS)
    rss, medians, sent = [], [], 0
    with console:
        console.start()
        began = time.monotonic()
        print("minute  RSS MB  key to log p50 ms  p99 ms  screen p50 ms  CPU %", flush=True)
        for minute in range(minutes):
            logged, drawn, cpu_s = [], [], console.cpu_s()
            while time.monotonic() < began + 60 * (minute + 1):
                key = keys[sent % len(keys)]
                sent += 1
                to_log, to_screen = send(console, log, key, SIGNALS[key])
                logged.append(to_log)
                drawn.append(to_screen)
                time.sleep(gap_s)
            rss.append(console.rss_bytes())
            medians.append(percentile(logged, 0.5))
            print(
                f"{minute + 1:>6}  {rss[-1] / 1e6:>6.1f}  {1000 * medians[-1]:>17.2f}  {1000 * percentile(logged, 0.99):>6.1f}"
                f"  {1000 * percentile(drawn, 0.5):>13.1f}  {100 * (console.cpu_s() - cpu_s) / 60:>5.1f}",
                flush=True,
            )
        console.quit()
    quarter = max(1, minutes // 4)
    for name, values in [("memory", rss), ("latency", medians)]:
        early = percentile(values[quarter : 2 * quarter] or values, 0.5)
        late = percentile(values[-quarter:], 0.5)
        print(f"{name}: the last quarter is {100 * (late / early - 1):+.1f} % of the second")
        assert late <= early * (1 + FLAT), f"{name} grows"


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("--minutes", type=int, default=120)
    asked.add_argument("--gap", type=float, default=1.0, help="seconds between signals")
    arguments = asked.parse_args()
    run(arguments.tomcom, arguments.folder / f"endurance-{os.getpid()}", arguments.minutes, arguments.gap)
