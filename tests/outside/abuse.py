"""Two hundred connections to the display that send nonsense, together a thousand messages a second, until they are killed.

    tests/outside/abuse.py PORT
"""

import asyncio
import contextlib
import json
import random
import sys

from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException

CONNECTIONS, PER_SECOND = 200, 1000


def nonsense(chance):
    press = {"kind": "press", "number": chance.randrange(1 << 40), "button": "take rice", "at": chance.random() * 1e6}
    return chance.choice([
        json.dumps(press),
        json.dumps(press | {"number": -1}),
        json.dumps(press | {"button": "no such button"}),
        json.dumps({"kind": "hello", "page": "x", "width": 1, "height": 1, "code": None}),
        json.dumps({"kind": "confirm"}),
        json.dumps({"kind": "pointer", "x": 1e300, "y": "here"}),
        "nonsense" * chance.randrange(1, 100),
        "{" * 900,
        "",
    ])


async def one(url, number, ready):
    chance = random.Random(number)
    while True:
        try:
            async with connect(url, open_timeout=20, ping_interval=None) as socket:
                await socket.send(json.dumps({"kind": "hello", "page": f"nobody-{number}", "width": 800, "height": 600, "code": None}))
                await socket.recv()
                ready.release()
                drain = asyncio.create_task(read(socket))
                while not drain.done():
                    await socket.send(nonsense(chance))
                    await asyncio.sleep(CONNECTIONS / PER_SECOND * chance.uniform(0.5, 1.5))
        except (OSError, WebSocketException, TimeoutError):
            # Whoever sends too much nonsense is thrown out, and comes again.
            await asyncio.sleep(0.2)


async def read(socket):
    with contextlib.suppress(WebSocketException):
        async for _ in socket:
            pass


async def main(port):
    ready = asyncio.Semaphore(0)
    tasks = [asyncio.create_task(one(f"ws://127.0.0.1:{port}/talk", number, ready)) for number in range(CONNECTIONS)]
    for _ in range(CONNECTIONS):
        await ready.acquire()
    print(f"{CONNECTIONS} connections", flush=True)
    await asyncio.gather(*tasks)


if __name__ == "__main__":
    asyncio.run(main(int(sys.argv[1])))
