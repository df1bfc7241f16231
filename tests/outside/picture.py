"""Makes the picture of the README: a session in the real program, as a terminal shows it.

    tests/outside/picture.py TOMCOM FOLDER [--seconds 75] [--size 120x40] [--out tests/snapshots/console.svg]
"""

import os
import time
from html import escape
from pathlib import Path

from console import Console, parser

COLUMN, ROW, MARGIN = 8.4, 18, 12
TEXT, GROUND = "#d8d8d8", "#1e1e1e"


def colour(name, otherwise):
    return otherwise if name == "default" else f"#{name}"


def runs(line, columns):
    """Stretches of cells that look the same: column, text, colour, background, bold."""
    start = 0
    while start < columns:
        look = style(line[start])
        end = start
        while end < columns and style(line[end]) == look:
            end += 1
        yield start, "".join(line[x].data for x in range(start, end)), *look
        start = end


def style(cell):
    text, ground = colour(cell.fg, TEXT), colour(cell.bg, GROUND)
    return (ground, text, cell.bold) if cell.reverse else (text, ground, cell.bold)


def svg(screen):
    width, height = screen.columns * COLUMN + 2 * MARGIN, screen.lines * ROW + 2 * MARGIN
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
        'font-family="DejaVu Sans Mono, Menlo, Consolas, monospace" font-size="14">',
        f'<rect width="100%" height="100%" rx="8" fill="{GROUND}"/>',
    ]
    for y in range(screen.lines):
        for x, text, front, ground, bold in runs(screen.buffer[y], screen.columns):
            left, top = MARGIN + x * COLUMN, MARGIN + y * ROW
            if ground != GROUND:
                parts.append(f'<rect x="{left:.1f}" y="{top}" width="{len(text) * COLUMN:.1f}" height="{ROW}" fill="{ground}"/>')
            if not text.strip():
                continue
            indent = len(text) - len(text.lstrip())
            text = text.strip()
            weight = ' font-weight="bold"' if bold else ""
            parts.append(
                f'<text x="{left + indent * COLUMN:.1f}" y="{top + 13.5}" fill="{front}"{weight} '
                f'textLength="{len(text) * COLUMN:.1f}" lengthAdjust="spacingAndGlyphs" xml:space="preserve">{escape(text)}</text>'
            )
    return "\n".join([*parts, "</svg>", ""])


if __name__ == "__main__":
    asked = parser(__doc__)
    asked.add_argument("--seconds", type=float, default=75)
    asked.add_argument("--size", default="120x40")
    asked.add_argument("--out", type=Path, default=Path("tests/snapshots/console.svg"))
    arguments = asked.parse_args()
    size = tuple(int(number) for number in arguments.size.split("x"))
    recordings = arguments.folder / f"picture-{os.getpid()}"
    with Console(arguments.tomcom, ["sessions/default.toml", "--code", "P01", "--out", recordings], size) as console:
        console.wait_for("READY")
        console.start()
        # Signals on the way, so that the timeline has some; the picture shows the next offer.
        for key, share in [("w", 0.6), ("p", 0.8)]:
            until = arguments.seconds * share
            while console.trial_s() < until:
                time.sleep(0.05)
            console.key(key)
        while console.trial_s() < arguments.seconds:
            time.sleep(0.05)
        console.wait_for("saves . [0-9]+ press", 200)
        time.sleep(0.9)
        with console.lock:
            arguments.out.write_text(svg(console.screen))
        print(f"{arguments.out}:\n{console.text()}")
        console.quit()
