#!/usr/bin/env python3
"""Draws poster.svg: a sunset in six flat inks, in the manner of a linocut.

    python3 examples/art/poster.py > examples/art/poster.svg

There are filled paths and basic shapes only, one ink each. `frame` is the picture that a single plate would print: the arch, and in
it tones made of nothing but lines, thicker where it is darker: straight ones in the dusk, runs across the sun, spears that fall
from the peaks, waves in the sea. The flat colours lie beneath it (`sky`, `halo`, `sun`, `hills`, `sea`) and go on where others cover
them, so that they can be combined: try `sun ^ waves`.

Units are millimetres on an A0 sheet. Standard library only; the same bytes come out every time.
"""

from math import acos, ceil, cos, hypot, pi, sin, sqrt

from letters import letter
from svg import Drawing, Path, clip, minus

WIDTH, HEIGHT = 841, 1189
NIGHT, TEAL, RED, ORANGE, BLUSH, CREAM = "#14213d", "#2c7f86", "#e4472f", "#f4a950", "#fad3a4", "#fff3dc"

# The arch: its outline, the thickness of its line, and the white line inside it.
LEFT, RIGHT, TOP, BOTTOM = 110.5, 730.5, 78, 884
BORDER, GAP = 7, 4
MIDDLE = WIDTH / 2
SPRING = TOP + (RIGHT - LEFT) / 2  # where the curve begins

# The view through it.
INNER_LEFT, INNER_RIGHT = LEFT + BORDER + GAP, RIGHT - BORDER - GAP
INNER_TOP, INNER_BOTTOM = TOP + BORDER + GAP, BOTTOM - BORDER - GAP
INNER_RADIUS = SPRING - INNER_TOP
HORIZON = 628
SUN_Y, SUN_R = 552, 148

# Peaks from far to near: x, y, feet on the left and right, and whether the sun stands on their right.
PEAKS = [
    (222, 402, 78, 384, True),
    (146, 484, 40, 262, True),
    (312, 556, 236, 404, True),
    (652, 484, 524, 790, False),
    (560, 560, 486, 642, False),
]

ROW = 9.2  # from one line of the dusk to the next
CLOUDS = [  # row, left, right, ink
    (24, 214, 286, RED), (25, 164, 248, RED), (25, 262, 318, RED), (26, 196, 262, RED),
    (30, 572, 634, RED), (31, 536, 606, RED), (31, 620, 676, RED), (32, 588, 652, RED),
    (41, 486, 600, CREAM), (42, 524, 566, CREAM), (42, 580, 622, CREAM),
]
STARS = [
    (MIDDLE, 128, 12), (340, 156, 8), (506, 150, 8.5), (268, 200, 10.5), (586, 192, 11), (388, 196, 7), (464, 222, 8), (200, 268, 8.5),
    (648, 258, 9.5), (318, 250, 7), (544, 262, 7),
]
EMBLEM = [  # an R, written as the runs of six scanlines
    [(0, 5)],
    [(0, 2), (4, 6)],
    [(0, 2), (4, 6)],
    [(0, 5)],
    [(0, 2), (3, 5)],
    [(0, 2), (4, 6)],
]


def smooth(t):
    """From 0 to 1 while t does, level at both ends."""
    t = min(1.0, max(0.0, t))
    return t * t * (3 - 2 * t)


def arch(inset):
    """The window's outline, drawn in by `inset`."""
    left, right, bottom = LEFT + inset, RIGHT - inset, BOTTOM - inset
    return Path().move(left, bottom).line((left, SPRING)).arc(SPRING - TOP - inset, right, SPRING).line((right, bottom)).close()


def sides(y):
    """Where the view begins and ends at height y."""
    up = max(0, SPRING - y)
    half = sqrt(max(0.0, INNER_RADIUS**2 - up**2))
    return MIDDLE - half, MIDDLE + half


# Hills

def mountain(peak, margin):
    """A peak's outline, clockwise, its slopes moved out by the margin."""
    x, y, left, right, _ = peak
    tall = HORIZON - y
    a, b = left - margin * hypot(x - left, tall) / tall, right + margin * hypot(right - x, tall) / tall
    grown = (b - a) / (right - left)
    return [(a + (x - left) * grown, HORIZON - tall * grown), (b, HORIZON), (a, HORIZON)]


def in_view(polygon):
    return clip(clip(polygon, (INNER_LEFT, 1), (INNER_LEFT, 0)), (INNER_RIGHT, 0), (INNER_RIGHT, 1))


def in_front(polygon, peaks):
    """What the peaks and a keyline around them leave of a convex polygon, as convex pieces."""
    pieces = [in_view(polygon)]
    for peak in peaks:
        pieces = [rest for piece in pieces if piece for rest in minus(piece, mountain(peak, 0.8))]
    return [piece for piece in pieces if piece]


def faces(peak):
    """The two faces of a peak, each with its feet and whether the sun shines on it."""
    x, _, left, right, sun_on_right = peak
    foot = x + (left + right - 2 * x) * 0.12
    return (left, foot, not sun_on_right), (foot, right, sun_on_right)


def spears():
    """Spears that point to the peaks from below, broad in the shade, their tips a snow line."""
    for i, peak in enumerate(PEAKS):
        x, y = peak[:2]
        for a, b, lit in faces(peak):
            count = max(3, round((b - a) / (11 if lit else 9.5)))
            half = (b - a) / count * (0.17 if lit else 0.37)
            for k in range(count):
                foot = a + (b - a) * (k + 0.5) / count
                snow = (0.32 if lit else 0.18) + (0.12 if k % 2 else 0)
                tip = (x + (foot - x) * snow, y + (HORIZON - y) * snow)
                yield from in_front([tip, (foot + half, HORIZON), (foot - half, HORIZON)], PEAKS[i + 1:])


# Sky

def away(x, y, peak):
    """Distance from a peak's slopes; 0 on the mountain."""
    px, py, left, right, _ = peak
    nearest = 1e9
    inside = True
    for foot in (left, right):
        dx, dy = foot - px, HORIZON - py
        t = min(1.0, max(0.0, ((x - px) * dx + (y - py) * dy) / (dx * dx + dy * dy)))
        nearest = min(nearest, hypot(x - px - t * dx, y - py - t * dy))
        inside = inside and (dx * (y - py) - dy * (x - px)) * (foot - px) >= 0
    return 0 if inside else nearest


def dusk(x, y):
    """Share of ink in the sky: none near the sun and close to the peaks, nearly all of it at the top."""
    height = min(1.0, max(0.0, (hypot(x - MIDDLE, y - SUN_Y) - 192) / 274)) ** 0.9
    return 0.93 * height * smooth((min(away(x, y, peak) for peak in PEAKS) - 2.5) / 10)


def dusk_lines():
    """The sky's lines: where the tone is not too thin to print, from the arch or from a point."""
    y, thin = INNER_TOP + ROW / 2, 0.16
    while y < HORIZON:
        half = lambda x: ROW / 2 * dusk(x, y)
        left, right = sides(y)
        at = lambda i: left + (right - left) * i / 800
        solid = [half(at(i)) > thin for i in range(801)]
        starts = [i for i in range(801) if solid[i] and not (i and solid[i - 1])]
        ends = [i for i in range(801) if solid[i] and not (i < 800 and solid[i + 1])]
        for i, j in zip(starts, ends):
            if at(j) - at(i) > 18:
                yield dusk_line(y, half, at(i), at(j), i == 0, j == 800)
        y += ROW


def dusk_line(y, half, a, b, cut_a, cut_b):
    above, below = lambda x: y - half(x), lambda x: y + half(x)

    def meet(f, side):
        """Where the edge f meets the arch."""
        x = (a, b)[side]
        for _ in range(60):
            x = sides(f(x))[side]
        return x

    a0, a1 = (meet(above, 0), meet(below, 0)) if cut_a else (a, a)
    b0, b1 = (meet(above, 1), meet(below, 1)) if cut_b else (b, b)
    path = Path().move(a0, above(a0)).graph(above, a0, b0)
    if not cut_b:
        path.line((b + 9 * half(b), y), (b, below(b)))
    elif y < SPRING:
        path.arc(INNER_RADIUS, b1, below(b1))
    else:
        path.line((b1, below(b1)))
    path.graph(below, b1, a1)
    if not cut_a:
        path.line((a - 9 * half(a), y))
    elif y < SPRING:
        path.arc(INNER_RADIUS, a0, above(a0))
    return path.close()


# Sun

def sun_runs():
    """The sun above the horizon: whole at the top, then in bars that grow thinner as the gaps between them grow wider."""
    bars = [(SUN_Y - SUN_R, SUN_Y - 44.0)]
    gap, bar = 2.2, 20.0
    while bars[-1][1] + gap < HORIZON:
        top = bars[-1][1] + gap
        bars.append((top, min(top + bar, HORIZON)))
        gap, bar = gap + 1.3, bar - 1.9
    for top, bottom in bars:
        first, last = acos((SUN_Y - top) / SUN_R), acos((SUN_Y - bottom) / SUN_R)
        steps = ceil((last - first) / 0.012)
        angles = [first + (last - first) * i / steps for i in range(steps + 1)]
        right = [(MIDDLE + SUN_R * sin(t), SUN_Y - SUN_R * cos(t)) for t in angles]
        left = [(2 * MIDDLE - x, y) for x, y in reversed(right) if x > MIDDLE]
        path = Path()
        for piece in in_front(right + left, PEAKS):
            path.polygon(piece)
        yield path


# Sea

def swell(v):
    """Line v of the sea, from 0 at the horizon to 1 at the shore, as a function of x."""
    level, height = HORIZON + 4 + 173 * v**1.5, 16.5 * v**1.3
    wave = lambda x, length, shift: sin(2 * pi * ((x - MIDDLE) / length + shift))
    return lambda x: level + height * (wave(x, 172, 0.95 * v + 0.25) + 0.35 * wave(x, 97, -0.8 * v))


def waves(count=21):
    """Bands that swell and thin from one line of the sea to the next, thinnest below the sun; then the shore."""
    for k in range(count):
        v = k / count
        above, below = swell(v), swell((k + 1) / count)

        def edge(x):
            crest = 0.52 + 0.2 * sin(2 * pi * ((x - MIDDLE) / 172 + 0.95 * v) - 1.2)
            shine = 0.22 + 0.78 * smooth((abs(x - MIDDLE) - 18) / (54 + 66 * v))
            return above(x) + (below(x) - above(x)) * (0.08 + crest * shine)

        path = Path().move(INNER_LEFT, above(INNER_LEFT)).graph(above, INNER_LEFT, INNER_RIGHT)
        yield path.line((INNER_RIGHT, edge(INNER_RIGHT))).graph(edge, INNER_RIGHT, INNER_LEFT).close()
    shore = swell(1)
    path = Path().move(INNER_LEFT, shore(INNER_LEFT)).graph(shore, INNER_LEFT, INNER_RIGHT)
    yield path.line((INNER_RIGHT, INNER_BOTTOM), (INNER_LEFT, INNER_BOTTOM)).close()


def glitter():
    """The sun on the water: runs, left and right end, height and thickness."""
    y, k = HORIZON + 7.0, 0
    while y < 786:
        v = (y - HORIZON) / 165
        half = (66 - 30 * v) * (1 - 0.35 * (k % 3)) + 5 * (k % 2)
        shift = (9 + 8 * v) * (-1 if k % 2 else 1) * (0.4 + 0.3 * (k % 3))
        thick = 2.4 + 3.6 * v
        yield MIDDLE + shift - half, MIDDLE + shift + half, y, thick
        y, k = y + thick + 3 + 5.2 * v, k + 1


# The sheet

def star(x, y, r):
    return [(x + q * sin(pi * i / 4), y - q * cos(pi * i / 4)) for i in range(8) for q in [r if i % 2 == 0 else r * 0.27]]


def word(d, text, x, base, height, weight, widths, gap, space=0):
    """Sets capitals from x on, and returns where they end."""
    for name in text:
        if name == " ":
            x += space - gap
        else:
            d.path(letter(Path(), name, x, base, height, widths[name], weight))
            x += widths[name] + gap
    return x - gap


def poster():
    d = Drawing(WIDTH, HEIGHT, "Runset, a poster, drawn by poster.py. CC0-1.0, see LICENSE.md.")
    # Flat colours, from back to front.
    d.path(arch(BORDER + GAP), id="sky", fill=BLUSH)
    with d.group(id="halo", fill=ORANGE):
        for k in range(13):
            inner, thick = SUN_R + 9 + 11.2 * k, 7.4 - 0.5 * k
            d.path(Path().ring(MIDDLE, SUN_Y, inner + thick, inner))
    d.add("circle", id="sun", cx=MIDDLE, cy=SUN_Y, r=SUN_R + 4, fill=CREAM)
    with d.group(id="hills"):
        for peak in PEAKS:
            for a, b, lit in faces(peak):
                d.polygon(in_view([peak[:2], (b, HORIZON), (a, HORIZON)]), fill=CREAM if lit else TEAL)
    d.rect(INNER_LEFT, HORIZON, INNER_RIGHT, INNER_BOTTOM, id="sea", fill=TEAL)
    # The plate.
    seal_y = BOTTOM - BORDER / 2
    with d.group(id="frame", fill=NIGHT):
        d.path(f"{arch(0)}{arch(BORDER)}", id="border", fill_rule="evenodd")
        with d.group(id="dusk"):
            for line in dusk_lines():
                d.path(line)
        with d.group(id="runs", fill=RED):
            for bar in sun_runs():
                d.path(bar)
        with d.group(id="spears"):
            path = Path()
            for piece in spears():
                path.polygon(piece)
            d.path(path)
        with d.group(id="waves"):
            for band in waves():
                d.path(band)
        d.add("circle", id="seal", cx=MIDDLE, cy=seal_y, r=50)
    # Lights on top of it.
    with d.group(id="glitter", fill=ORANGE):
        for left, right, y, thick in glitter():
            d.pill(left, right, y, thick)
    with d.group(id="clouds"):
        for row, left, right, ink in CLOUDS:
            with d.group(fill=ink):
                d.pill(left, right, INNER_TOP + (row + 0.5) * ROW, 7.4)
    with d.group(id="stars", fill=CREAM):
        for x, y, r in STARS:
            d.polygon(star(x, y, r))
    with d.group(id="logo", fill=ORANGE, transform=f"translate({MIDDLE} {seal_y})"):
        d.path(Path().ring(0, 0, 45, 41.8))
        for i, runs in enumerate(EMBLEM):
            for a, b in runs:
                d.pill((a - 3) * 8.6 + 0.6, (b - 3) * 8.6 - 0.6, (i - 2.5) * 9, 6.4)
    # Lettering and printer's marks.
    with d.group(id="title", fill=NIGHT):
        widths = dict(R=84, U=86, N=90, S=82, E=72, T=84)
        word(d, "RUNSET", LEFT, 1064, 102, 24, widths, (RIGHT - LEFT - sum(widths.values())) / 5)
    with d.group(id="tagline", fill=RED):
        text, widths = "ONE LINE AT A TIME", dict(O=17, N=13.6, E=10.8, L=10.2, I=3.4, A=15.6, T=13, M=17)
        gap, space = 8.6, 27
        length = sum(widths.get(name, space - gap) + gap * (name != " ") for name in text) - gap
        start = MIDDLE - length / 2
        end = word(d, text, start, 1106, 17, 3.4, widths, gap, space)
        for left, right in ((LEFT, start - 20), (end + 20, RIGHT)):
            d.rect(left, 1096.8, right, 1100.2)
    with d.group(id="marks", fill=NIGHT):
        for x in (40, WIDTH - 40):
            for y in (40, HEIGHT - 40):
                with d.group(transform=f"translate({x} {y})"):
                    d.path(Path().ring(0, 0, 7, 5.8))
                    d.rect(-12, -0.6, 12, 0.6)
                    d.rect(-0.6, -12, 0.6, 12)
        d.rect(MIDDLE - 36, HEIGHT - 48, MIDDLE + 36, HEIGHT - 32)
        for i, ink in enumerate((TEAL, RED, ORANGE, BLUSH, CREAM)):
            d.rect(MIDDLE - 34 + 14 * i, HEIGHT - 46, MIDDLE - 22 + 14 * i, HEIGHT - 34, fill=ink)
    return d


if __name__ == "__main__":
    print(poster())
