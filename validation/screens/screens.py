"""Screens of a page against references: mean brightness of cells, kept as small grey PNGs in validation/screens.

A reference is compared band by band, so that a small change is not lost in a long page. `planted` hides the lights of the first
screen; a comparison that does not see that sees nothing.
"""

import base64
import struct
import zlib
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
# View: width and height of the screen px, side of a cell px, dark, printed.
VIEWS = {
    "desktop": (1400, 900, 20, False, False),
    "phone": (390, 844, 10, False, False),
    "dark": (1400, 900, 20, True, False),
    # A4 at 96 dots per inch.
    "print": (794, 1123, 14, False, True),
}
# Longest part of a page that is compared, px.
LONGEST = 4000
# Rows of cells of a band, and its largest mean difference, levels of 255: text that moves by a fraction of a pixel makes less,
# three lines of text that are missing make more.
BAND = 6
TOLERANCE = 2.0
# Fonts that every Linux has, so that references do not depend on the machine.
FONT = "*, svg text { font-family: 'DejaVu Sans' !important; }"
PLANTED = ".lights { visibility: hidden; }"

CELLS = """
(async () => {
  const image = new Image(); image.src = "data:image/png;base64,%s"; await image.decode();
  const side = %d, canvas = document.createElement("canvas");
  canvas.width = image.width; canvas.height = image.height;
  const pen = canvas.getContext("2d"); pen.drawImage(image, 0, 0);
  const data = pen.getImageData(0, 0, image.width, image.height).data;
  const rows = [];
  for (let y = 0; y + side <= image.height; y += side) {
    const row = [];
    for (let x = 0; x + side <= image.width; x += side) {
      let sum = 0;
      for (let j = y; j < y + side; j++) for (let i = x; i < x + side; i++) {
        const at = 4 * (j * image.width + i);
        sum += 0.2126 * data[at] + 0.7152 * data[at + 1] + 0.0722 * data[at + 2];
      }
      row.push(Math.round(sum / side ** 2));
    }
    rows.push(row);
  }
  return rows;
})()
"""


def cells(browser, file, view, planted=False):
    """Rows of grey levels of one view of a page."""
    width, height, side, dark, printed = VIEWS[view]
    page = browser.open(file.as_uri(), width, height, dark=dark)
    if printed:
        page.call("Emulation.setEmulatedMedia", media="print")
    page.style(FONT + (PLANTED if planted else ""))
    page.settle()
    page.settle()
    tall = min(page.value("document.documentElement.scrollHeight"), LONGEST)
    shot = page.picture({"x": 0, "y": 0, "width": width, "height": tall})
    page.close()
    blank = browser.open("about:blank")
    found = blank.value(CELLS % (base64.b64encode(shot).decode(), side))
    blank.close()
    return found


def difference(found, wanted):
    """The largest mean difference of a band; infinite where the sizes differ by more than a band."""
    if len(found[0]) != len(wanted[0]) or abs(len(found) - len(wanted)) > BAND:
        return float("inf")
    worst = 0.0
    for at in range(0, min(len(found), len(wanted)), BAND):
        pairs = [
            abs(a - b)
            for one, other in zip(found[at : at + BAND], wanted[at : at + BAND])
            for a, b in zip(one, other)
        ]
        worst = max(worst, sum(pairs) / len(pairs))
    return worst


def reference(name, view):
    return FOLDER / f"{name}_{view}.png"


def write(path, rows):
    """A grey PNG without filters."""
    raw = b"".join(b"\0" + bytes(row) for row in rows)
    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    path.parent.mkdir(parents=True, exist_ok=True)
    parts = [chunk(b"IHDR", head), chunk(b"IDAT", zlib.compress(raw, 9)), chunk(b"IEND", b"")]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))


def read(path):
    """What `write` wrote."""
    data = path.read_bytes()
    at, size, packed = 8, (0, 0), b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        content = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            size = struct.unpack(">II", content[:8])
        elif kind == b"IDAT":
            packed += content
        at += 12 + length
    raw, width = zlib.decompress(packed), size[0]
    return [list(raw[k * (width + 1) + 1 : (k + 1) * (width + 1)]) for k in range(size[1])]
