"""Connections to the program that nobody wants, until they are killed.

    tests/outside/abuse.py PORT                  200 that want to watch the display; those let in send nonsense, 1,000 messages a second
    tests/outside/abuse.py PORT --silent 520     so many that say nothing, opened again when they are closed
    tests/outside/abuse.py PORT --guess 400      so many that guess the pairing code for ten seconds; prints what became of it
"""

import argparse
import asyncio
import contextlib
import json
import random
import time

from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException

CONNECTIONS, PER_SECOND = 200, 1000
# So many pages of an address may watch; a few less, since the page of a test may be one of them.
LET_IN = 30
GUESSING_S = 10
# Guesses come from another address of this machine than its pages do.
GUESSER = ("127.0.0.2", 0)
LOST = (OSError, WebSocketException, TimeoutError)


def hello(page, code=None):
    return json.dumps({"kind": "hello", "page": page, "width": 800, "height": 600, "code": code})


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


async def hear(socket, *kinds):
    """The next message of one of these kinds."""
    while True:
        message = json.loads(await socket.recv())
        if message["kind"] in kinds:
            return message


async def one(url, number, ready):
    chance = random.Random(number)
    while True:
        try:
            async with connect(url, open_timeout=20, ping_interval=None) as socket:
                await socket.send(hello(f"nobody-{number}"))
                await hear(socket, "role")
                ready.release()
                drain = asyncio.create_task(read(socket))
                while not drain.done():
                    await socket.send(nonsense(chance))
                    await asyncio.sleep(LET_IN / PER_SECOND * chance.uniform(0.5, 1.5))
        except LOST:
            # Whoever sends too much nonsense is thrown out, and comes again, as do those for whom there is no room.
            await asyncio.sleep(chance.uniform(0.5, 1.5))


async def read(socket):
    with contextlib.suppress(WebSocketException):
        async for _ in socket:
            pass


async def annoy(port):
    ready = asyncio.Semaphore(0)
    tasks = [asyncio.create_task(one(f"ws://127.0.0.1:{port}/talk", number, ready)) for number in range(CONNECTIONS)]
    for _ in range(LET_IN):
        await ready.acquire()
    print(f"{CONNECTIONS} connections", flush=True)
    await asyncio.gather(*tasks)


async def silent(port, count):
    opened = asyncio.Semaphore(0)

    async def say_nothing():
        while True:
            with contextlib.suppress(OSError):
                reader, writer = await asyncio.open_connection("127.0.0.1", port)
                opened.release()
                await reader.read()
                writer.close()
            await asyncio.sleep(1)

    tasks = [asyncio.create_task(say_nothing()) for _ in range(count)]
    for _ in range(count):
        await opened.acquire()
    print(f"{count} silent connections", flush=True)
    await asyncio.gather(*tasks)


async def guess(port, count):
    """As many codes as possible, in as many connections; how many were looked at."""
    until = time.monotonic() + GUESSING_S
    answers = {"wrong": 0, "locked": 0}

    async def one_of_them(number):
        chance = random.Random(number)
        while time.monotonic() < until:
            with contextlib.suppress(*LOST):
                async with connect(f"ws://127.0.0.1:{port}/talk", open_timeout=20, ping_interval=None, local_addr=GUESSER) as socket:
                    while time.monotonic() < until:
                        code = "".join(chance.choices("ABCDEFGHJKLMNPQRSTUVWXYZ23456789", k=6))
                        await socket.send(hello(f"guesser-{number}", code))
                        answers[(await hear(socket, "pairing"))["why"]] += 1
            # There is no room for so many: they try again.
            await asyncio.sleep(chance.uniform(0.5, 1.5))

    await asyncio.gather(*(one_of_them(number) for number in range(count)))
    print(json.dumps(answers), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("port", type=int)
    parser.add_argument("--silent", type=int)
    parser.add_argument("--guess", type=int)
    arguments = parser.parse_args()
    if arguments.silent:
        asyncio.run(silent(arguments.port, arguments.silent))
    elif arguments.guess:
        asyncio.run(guess(arguments.port, arguments.guess))
    else:
        asyncio.run(annoy(arguments.port))
