#!/usr/bin/env python3
"""Draws board.svg: a radio module's circuit board, rectangles and rectilinear polygons only.

    python3 examples/art/board.py > examples/art/board.svg

Every edge is level or upright, as in masks and plotter's films. Groups are what a board house gets as layers: `copper & outline - drill`
is the copper without the plating bar that joins the contacts beyond the board's edge, and with the holes punched;
`copper & mask` is the copper that the solder mask leaves bare. `clearance` is all copper, grown, so that
`ground - clearance - keepout` is the pour around it.

Units are millimetres. Standard library only; the same bytes come out every time.
"""

from svg import Drawing, Path

WIDTH, HEIGHT = 50, 80
BOARD, POUR, TRACK, GOLD, BASE, HOLE, SILK = "#12483c", "#1a5c4b", "#3f9a74", "#e9b44c", "#c9a36b", "#0c1f1b", "#f6efdc"
CLEARANCE, OPENING = 0.45, 0.1  # from copper to the pour, and from a pad to the solder mask

MIDDLE = 25
CHIP = 36  # height of the processor's centre
PITCH, CONTACT = 0.8, 1.2  # of the processor's pins and of the edge contacts
CONTACTS_TOP, EDGE = 69, 78

LETTERS = {  # rows of runs, in cells, five to a letter's width
    "R": [[(0, 4)], [(0, 1), (4, 5)], [(0, 1), (4, 5)], [(0, 4)], [(0, 1), (2, 3)], [(0, 1), (3, 4)], [(0, 1), (4, 5)]],
    "U": [[(0, 1), (4, 5)]] * 6 + [[(1, 4)]],
    "N": [[(0, 1), (4, 5)], [(0, 2), (4, 5)], [(0, 1), (2, 3), (4, 5)], [(0, 1), (3, 5)]] + [[(0, 1), (4, 5)]] * 3,
    "S": [[(1, 5)], [(0, 1)], [(0, 1)], [(1, 4)], [(4, 5)], [(4, 5)], [(0, 4)]],
    "E": [[(0, 5)], [(0, 1)], [(0, 1)], [(0, 4)], [(0, 1)], [(0, 1)], [(0, 5)]],
    "T": [[(0, 5)]] + [[(2, 3)]] * 6,
}


class Board:
    """Tracks as corner points and a width, everything else as centre and size."""

    def __init__(self):
        self.tracks, self.plating, self.pads, self.vias, self.holes = [], [], [], [], []

    def track(self, width, *points):
        self.tracks.append((points, width))

    def pad(self, x, y, w, h):
        self.pads.append((x, y, w, h))

    def via(self, x, y, size=0.9, hole=0.4):
        self.vias.append((x, y, size, size))
        self.holes.append((x, y, hole, hole))

    def two_pads(self, x, y, level=True):
        """A small part: two pads, side by side or one above the other."""
        for s in (-0.75, 0.75):
            self.pad(x + s * level, y + s * (not level), 0.7 if level else 0.9, 0.9 if level else 0.7)


def band(points, width):
    """The outline of a rectilinear track with square ends."""
    half = width / 2
    step = lambda p, q: ((q[0] > p[0]) - (q[0] < p[0]), (q[1] > p[1]) - (q[1] < p[1]))
    points = [p for i, p in enumerate(points) if i == 0 or p != points[i - 1]]
    inner = [q for p, q, r in zip(points, points[1:], points[2:]) if step(p, q) != step(q, r)]
    points = [points[0], *inner, points[-1]]
    ways = [step(p, q) for p, q in zip(points, points[1:])]
    left, right = [], []
    for i, (x, y) in enumerate(points):
        (ax, ay), (bx, by) = ways[max(i - 1, 0)], ways[min(i, len(ways) - 1)]
        if i == 0 or i == len(ways):  # an end: half a width on, and half a width aside
            s = -half if i == 0 else half
            x, y, nx, ny = x + s * bx, y + s * by, -by * half, bx * half
        else:
            nx, ny = -(ay + by) * half, (ax + bx) * half
        left.append((x + nx, y + ny))
        right.append((x - nx, y - ny))
    return left + right[::-1]


def layout():
    b = Board()
    pin = lambda k: (k - 5.5) * PITCH
    contact = lambda j: MIDDLE + (j - 17.5) * CONTACT
    # The processor: twelve pins a side.
    for k in range(12):
        for s in (-1, 1):
            b.pad(MIDDLE + s * 7.4, CHIP + pin(k), 1.6, 0.45)
            b.pad(MIDDLE + pin(k), CHIP + s * 7.4, 0.45, 1.6)
    # Edge contacts with the plating bar beyond the edge.
    for j in range(36):
        b.pad(contact(j), (CONTACTS_TOP + 76.8) / 2, 0.75, 76.8 - CONTACTS_TOP)
        b.plating.append(([(contact(j), 76.8), (contact(j), 79)], 0.25))
    b.plating.append(([(contact(0), 79), (contact(35), 79)], 0.6))
    # Left and right pins to the outer contacts: nested corners, the upper pin outside.
    for k in range(12):
        y, lane, jog, foot = CHIP + pin(k), contact(0) + PITCH * k, 55 + PITCH * (11 - k), contact(k)
        for m in (lambda x: x, lambda x: 2 * MIDDLE - x):
            b.track(0.3, (m(MIDDLE - 7.4), y), (m(lane), y), (m(lane), jog), (m(foot), jog), (m(foot), CONTACTS_TOP))
    # Lower pins to the middle contacts: a fan, the outer pin first.
    for k in range(12):
        x, foot, jog = MIDDLE + pin(k), contact(12 + k), 46.4 + PITCH * min(k, 11 - k)
        b.track(0.3, (x, CHIP + 7.4), (x, jog), (foot, jog), (foot, CONTACTS_TOP))
    # Upper pins: four to the resistors, four to the memory, two to the crystal, one to the antenna, one to the ground.
    for k in range(4):
        row = 26.2 - 0.9 * k
        b.track(0.3, (MIDDLE + pin(k), CHIP - 7.4), (MIDDLE + pin(k), row), (19.1, row))
        b.pad(18.7, row, 0.9, 0.55)
        b.pad(17.1, row, 0.9, 0.55)
        b.track(0.3, (MIDDLE - pin(k), CHIP - 7.4), (MIDDLE - pin(k), row), (34.6, row))
    b.track(0.3, (17.1, 23.5), (17.1, 26.2))
    for k in (4, 7):
        b.track(0.3, (MIDDLE + pin(k), CHIP - 7.4), (MIDDLE + pin(k), 22))
    b.pad(23.3, 21.6, 1.3, 2)
    b.pad(26.7, 21.6, 1.3, 2)
    b.track(0.3, (25.4, CHIP - 7.4), (25.4, 21.6))
    b.via(25.4, 21.6, 0.75, 0.35)
    # The memory: seven pins a side.
    for k in range(7):
        b.pad(35.0, 20.8 + 0.9 * k, 1.5, 0.5)
        b.pad(41.0, 20.8 + 0.9 * k, 1.5, 0.5)
        if k % 2 == 0:
            b.track(0.3, (41, 20.8 + 0.9 * k), (43, 20.8 + 0.9 * k))
            b.via(43, 20.8 + 0.9 * k)
    b.track(0.3, (35, 20.8), (33, 20.8))
    b.via(33, 20.8)
    # The coil: a square spiral, its inner end a via.
    x0, y0, x1, y1, turn = 5.2, 19.4, 14.8, 29.0, 0.9
    points = [(17.1, 26.2), (17.1, y1), (x0, y1)]
    while x1 - x0 > 3.4:
        points += [(x0, y0), (x1, y0), (x1, y1 - turn), (x0 + turn, y1 - turn)]
        x0, y0, x1, y1 = x0 + turn, y0 + turn, x1 - turn, y1 - turn
    points += [(x0, y0 + 0.9), (x0 + 1.5, y0 + 0.9)]
    b.track(0.45, *points)
    b.via(*points[-1], 1.1, 0.5)
    # The antenna: a feed and a meander.
    left, right, low, high, step = 10.6, 39.4, 13.4, 5, 1.6
    b.track(0.3, (24.6, CHIP - 7.4), (24.6, 17.2), (left, 17.2))
    points, x = [(left, 17.2)], left
    while x < right:
        points += [(x, high), (x + step, high), (x + step, low), (x + 2 * step, low)]
        x += 2 * step
    b.track(0.8, *points, (x, high))
    # Holes for screws, capacitors around the processor, vias that stitch the grounds.
    for x in (6.2, 43.8):
        b.pad(x, 6.2, 4.4, 4.4)
        b.holes.append((x, 6.2, 2.6, 2.6))
    for y in (49.6, 52.4):
        b.two_pads(16.4, y, False)
        b.two_pads(33.6, y, False)
    for k in range(22):
        for x in (2.95, 47.05):
            b.via(x, 15.6 + 2.4 * k, 0.7, 0.35)
    for k in range(3):
        for m in range(3):
            b.via(MIDDLE + (k - 1) * 2.2, CHIP + (m - 1) * 2.2, 1.0, 0.45)
    b.pad(MIDDLE, CHIP, 6.4, 6.4)
    return b


def rects(d, shapes, grow=0.0):
    for x, y, w, h in shapes:
        d.rect(x - w / 2 - grow, y - h / 2 - grow, x + w / 2 + grow, y + h / 2 + grow)


def symmetric(left):
    """A polygon from its left half, top to bottom."""
    return left + [(2 * MIDDLE - x, y) for x, y in reversed(left)]


def frame(d, left, top, right, bottom, t):
    d.rect(left, top, right, top + t)
    d.rect(left, bottom - t, right, bottom)
    d.rect(left, top + t, left + t, bottom - t)
    d.rect(right - t, top + t, right, bottom - t)


def text(d, string, left, top, cell):
    path = Path()
    for i, name in enumerate(string):
        for row, runs in enumerate(LETTERS[name]):
            for a, b in runs:
                path.box(left + (6 * i + a) * cell, top + row * cell, left + (6 * i + b) * cell, top + (row + 1) * cell)
    d.path(path)


def board():
    b = layout()
    d = Drawing(WIDTH, HEIGHT, "A radio module, drawn by board.py. CC0-1.0, see LICENSE.md.")
    left = [(2, 67.8), (3, 67.8), (3, 77.4), (3.6, 77.4), (3.6, EDGE)]
    d.polygon(symmetric([(4, 2), (4, 3), (3, 3), (3, 4), (2, 4), *left]), id="outline", fill=BOARD)
    d.polygon(symmetric([(4.4, 2.4), (4.4, 3.4), (3.4, 3.4), (3.4, 4.4), (2.4, 4.4), (2.4, 67.4)]), id="ground", fill=POUR)
    with d.group(id="clearance", fill=BOARD):
        for points, width in b.tracks:
            d.polygon(band(points, width + 2 * CLEARANCE))
        signals = [via for via in b.vias if abs(via[0] - MIDDLE) < 22]  # those along the edges belong to the ground
        rects(d, b.pads + signals, CLEARANCE)
        d.rect(4.6, 18.8, 15.4, 29.6)  # the coil wants no ground near it
    d.rect(9, 2, 41, 15, id="keepout", fill=BOARD)
    with d.group(id="mask", fill=BASE):
        rects(d, b.pads, OPENING)
    with d.group(id="copper", fill=TRACK):
        with d.group(id="tracks"):
            for points, width in b.tracks:
                d.polygon(band(points, width))
            for points, width in b.plating:
                d.polygon(band(points, width))
        with d.group(id="vias"):
            rects(d, b.vias)
        with d.group(id="pads", fill=GOLD):
            rects(d, b.pads)
    with d.group(id="drill", fill=HOLE):
        rects(d, b.holes)
    with d.group(id="silk", fill=SILK):
        frame(d, MIDDLE - 6, CHIP - 6, MIDDLE + 6, CHIP + 6, 0.2)
        d.rect(MIDDLE - 5.4, CHIP - 5.4, MIDDLE - 4.6, CHIP - 4.6)
        frame(d, 36.2, 20, 39.8, 27, 0.2)
        d.rect(36.8, 20.6, 37.4, 21.2)
        frame(d, 22.2, 20.2, 27.8, 23, 0.15)
        text(d, "RUNSET", 28.6, 15.8, 0.4)
    return d


if __name__ == "__main__":
    print(board())
