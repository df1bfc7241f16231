"""The pictures of items, dishes and places that Rerun shows are those of the participant's page: each look of the kitchens
that come with the program, drawn by the page's art.js in a browser. With --write they are made anew.

    tests/outside/rerun_pictures.py TOMCOM FOLDER [--write]
"""

import argparse
import io
import re
from pathlib import Path

from PIL import Image, ImageChops, ImageStat

from page import browser

PICTURES = Path("src/devices/scene/pictures")
ART = Path("src/devices/display/page/art.js")
# A picture is so many pixels high, and has so many colours; the box of a place is drawn so wide for a height of 100.
HIGH, COLOURS, WIDE = 72, 40, 150
# Another version of the browser draws edges a little differently.
MOST_DIFFERENCE = 4
PLACES = ["human_hand", "robot_hand"]
# Of nothing, and of the ground of an order. Nothing is as large as an item, and coded alike: in the viewer a picture takes the
# place of another one of its kind only.
PLAIN = {"blank": ((HIGH, HIGH), (0, 0, 0, 0)), "card": ((1, 1), (255, 253, 249, 255))}


def looks():
    """All looks of recipes and layouts, "fillet #f08a62", and those of places, which have no colours."""
    text = "\n".join(path.read_text() for folder in ("recipes", "layouts") for path in sorted(Path(folder).glob("*.toml")))
    named = re.findall(r'^\s*look = (.*)$', text, re.MULTILINE)
    return sorted({*PLACES, *(look for line in named for look in re.findall(r'"([a-z_]+(?: #[0-9a-f]{6})*)"', line))})


def draw(page, look):
    if look in PLAIN:
        return Image.new("RGBA", *PLAIN[look]).quantize(COLOURS, Image.Quantize.FASTOCTREE)
    shape, *colours = look.split()
    is_place = not colours
    wide = HIGH * WIDE // 100 if is_place else HIGH
    item = {"label": "", "look": {"shape": shape, "colours": colours}}
    made = page.evaluate("([shape, item, wide]) => item ? Art.item({ items: { it: item } }, 'it') : Art.place(shape, wide)", [shape, None if is_place else item, WIDE])
    page.set_content(f'<style>body {{ margin: 0; background: transparent }} svg {{ display: block; width: {4 * wide}px; height: {4 * HIGH}px }}</style>{made}')
    page.add_script_tag(path=ART)
    shot = page.screenshot(omit_background=True, clip={"x": 0, "y": 0, "width": 4 * wide, "height": 4 * HIGH})
    large = Image.open(io.BytesIO(shot)).convert("RGBA")
    return large.resize((wide, HIGH), Image.Resampling.LANCZOS).quantize(COLOURS, Image.Quantize.FASTOCTREE)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tomcom")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    wanted = {look.replace(" #", "-") + ".png": look for look in [*PLAIN, *looks()]}
    there = {path.name for path in PICTURES.glob("*.png")}
    with browser() as chromium:
        page = chromium.new_page(viewport={"width": 4 * HIGH * WIDE // 100, "height": 4 * HIGH})
        page.set_content("")
        page.add_script_tag(path=ART)
        for name, look in wanted.items():
            drawn, path = draw(page, look), PICTURES / name
            if arguments.write:
                drawn.save(path, optimize=True, bits=8)
                continue
            assert name in there, f"{path} is not there: make it with --write"
            difference = ImageChops.difference(drawn.convert("RGBA"), Image.open(path).convert("RGBA"))
            most = max(ImageStat.Stat(difference).mean)
            assert most <= MOST_DIFFERENCE, f"{path} is not as the page draws it now ({most:.1f} of 255): make it anew with --write"
    assert arguments.write or there == wanted.keys(), f"pictures that nothing shows: {there - wanted.keys()}"
    print(f"  {len(wanted)} pictures, as the page draws them")


if __name__ == "__main__":
    main()
