"""What the generators here share: numbers, path data, elements, and the clipping of convex polygons.

The y axis points down, as in SVG; "clockwise" is as seen on the sheet.
"""


def number(v):
    """At most two decimals: a hundredth of a millimetre is less than a dot at 2400 dpi."""
    text = f"{v:.2f}".rstrip("0").rstrip(".") if isinstance(v, float) else str(v)
    return "0" if text == "-0" else text


def numbers(values):
    """Numbers as path data has them: a minus sign is separation enough."""
    text = ""
    for v in map(number, values):
        text += v if not text or v.startswith("-") else " " + v
    return text


class Path:
    """Path data in relative coordinates. What rounding takes from one point is given to the next."""

    def __init__(self):
        self.data, self.x, self.y = [], 0.0, 0.0

    def _relative(self, points):
        flat = [v - (self.y if i % 2 else self.x) for i, v in enumerate(v for p in points for v in p)]
        self.x += float(number(float(flat[-2])))
        self.y += float(number(float(flat[-1])))
        return numbers(map(float, flat))

    def move(self, x, y):
        self.x = self.y = 0.0
        self.data.append("M" + self._relative([(x, y)]))
        return self

    def line(self, *points):
        self.data.extend("l" + self._relative([p]) for p in points)
        return self

    def cubic(self, b, c, d):
        self.data.append("c" + self._relative([b, c, d]))
        return self

    def arc(self, r, x, y, clockwise=True):
        """A circular arc of at most half a turn."""
        self.data.append(f"a{number(float(r))} {number(float(r))} 0 0 {int(clockwise)} " + self._relative([(x, y)]))
        return self

    def close(self):
        self.data.append("z")
        return self

    def polygon(self, points):
        return self.move(*points[0]).line(*points[1:]).close()

    def box(self, left, top, right, bottom):
        return self.polygon([(left, top), (right, top), (right, bottom), (left, bottom)])

    def ring(self, cx, cy, outer, inner):
        """Two circles, the inner one the other way round: a ring under either fill rule."""
        for r, clockwise in ((outer, True), (inner, False)):
            self.move(cx - r, cy).arc(r, cx + r, cy, clockwise).arc(r, cx - r, cy, clockwise).close()
        return self

    def graph(self, f, a, b, tolerance=0.05):
        """Follows y = f(x) from a to b, in either direction, in as few cubics as the tolerance allows."""
        slope = lambda x: (f(x + 0.01) - f(x - 0.01)) / 0.02
        todo = [(a, b)]
        while todo:
            a, b = todo.pop()
            third = (b - a) / 3
            p = [f(a), f(a) + slope(a) * third, f(b) - slope(b) * third, f(b)]
            bezier = lambda t, u: u**3 * p[0] + 3 * u * t * (u * p[1] + t * p[2]) + t**3 * p[3]
            error = max(abs(bezier(t, 1 - t) - f(a + t * (b - a))) for t in (0.2, 0.4, 0.6, 0.8))
            if (error > tolerance and abs(b - a) > 1) or abs(b - a) > 80:
                middle = (a + b) / 2
                todo += [(middle, b), (a, middle)]
            else:
                self.cubic((a + third, p[1]), (b - third, p[2]), (b, p[3]))
        return self

    def __str__(self):
        return "".join(self.data)


class Drawing:
    """The elements of an SVG document, indented by group."""

    def __init__(self, width, height, note):
        self.lines, self.depth = [], 1
        self.head = (
            '<?xml version="1.0" encoding="UTF-8"?>\n'
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">\n'
            f"  <!-- {note} -->"
        )

    def _put(self, text):
        self.lines.append("  " * self.depth + text)

    @staticmethod
    def _attributes(attributes):
        return "".join(f' {k.replace("_", "-")}="{number(v)}"' for k, v in attributes.items())

    def add(self, element, **attributes):
        self._put(f"<{element}{self._attributes(attributes)}/>")

    def path(self, path, **attributes):
        self.add("path", d=str(path), **attributes)

    def polygon(self, points, **attributes):
        self.add("polygon", points=" ".join(",".join(number(float(v)) for v in p) for p in points), **attributes)

    def rect(self, left, top, right, bottom, **attributes):
        self.add("rect", x=float(left), y=float(top), width=float(right - left), height=float(bottom - top), **attributes)

    def pill(self, left, right, y, height):
        """A bar with round ends on the line y: a run."""
        self.rect(left, y - height / 2, right, y + height / 2, rx=height / 2)

    def group(self, **attributes):
        self._put(f"<g{self._attributes(attributes)}>")
        self.depth += 1
        return self

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.depth -= 1
        self._put("</g>")

    def __str__(self):
        return "\n".join([self.head, *self.lines, "</svg>"])


def clip(polygon, a, b):
    """The part of a convex polygon on the right of the way from a to b."""
    side = lambda p: (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    kept = []
    for p, q in zip(polygon, polygon[1:] + polygon[:1]):
        sp, sq = side(p), side(q)
        if sp >= 0:
            kept.append(p)
        if sp * sq < 0:
            t = sp / (sp - sq)
            kept.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
    return kept if len(kept) > 2 else []


def minus(polygon, hole):
    """A convex polygon without a clockwise convex one, as convex pieces."""
    pieces = []
    for a, b in zip(hole, hole[1:] + hole[:1]):
        pieces.append(clip(polygon, b, a))
        polygon = clip(polygon, a, b)
    return [piece for piece in pieces if piece]
