"""Geometric capitals of one weight, as filled outlines. Only the letters that the poster needs."""


def letter(path, name, x, base, h, w, t):
    """Adds a capital: left end x, baseline, height h, width w, weight t."""
    top, right, mid, c = base - h, x + w, base - h / 2, x + w / 2
    if name == "A":
        foot = t * 1.08  # a slanted stem, measured along the baseline
        lean = (w - foot) / 2 / h
        outer = lambda y: x + (base - y) * lean
        inner = lambda y: outer(y) + foot
        bar0, bar1 = base - h * 0.2 - t * 0.9, base - h * 0.2
        half = [(outer(top), top), (x, base), (inner(base), base), (inner(bar1), bar1)]
        path.polygon(half + [(2 * c - a, b) for a, b in reversed(half)])
        path.polygon([(inner(bar0), bar0), (c, base - (c - x - foot) / lean), (2 * c - inner(bar0), bar0)])
    elif name == "E":
        tongue = right - t * 0.4
        half = [(x, top), (right, top), (right, top + t), (x + t, top + t), (x + t, mid - t / 2), (tongue, mid - t / 2)]
        path.polygon(half + [(a, 2 * mid - b) for a, b in reversed(half)])
    elif name == "I":
        path.box(x, top, right, base)
    elif name == "L":
        path.polygon([(x, top), (x + t, top), (x + t, base - t), (right, base - t), (right, base), (x, base)])
    elif name == "M":
        d = t * 1.05
        half = [(c, base - h * 0.1), (x + t, top + h * 0.3), (x + t, base), (x, base), (x, top), (x + d, top), (c, base - h * 0.42)]
        path.polygon(half + [(2 * c - a, b) for a, b in half[-2:0:-1]])
    elif name == "N":
        d = t * 1.12
        half = [(x, base), (x, top), (x + d, top), (right - t, base - h * 0.36), (right - t, top)]
        path.polygon(half + [(2 * c - a, 2 * mid - b) for a, b in half])
    elif name == "O":
        path.ring(c, mid, w / 2, w / 2 - t)
    elif name == "R":
        r = h * 0.3
        waist = top + 2 * r
        hip, leg = waist - t / 2, t * 1.14
        path.move(x, top).line((right - r, top)).arc(r, right - r, waist).line((x + t, waist), (x + t, base), (x, base)).close()
        path.polygon([(right - r * 0.85 - leg, hip), (right - r * 0.85, hip), (right, base), (right - leg, base)])
        path.move(x + t, top + t).line((x + t, waist - t), (right - r, waist - t)).arc(r - t, right - r, top + t, False).close()
    elif name == "S":
        r = (h + t) / 4  # two bowls that share the middle bar
        a, b = x + r, right - r
        path.move(right, top).line((a, top)).arc(r, a, mid + t / 2, False).line((b, mid + t / 2)).arc(r - t, b, base - t)
        path.line((x, base - t), (x, base), (b, base)).arc(r, b, mid - t / 2, False).line((a, mid - t / 2)).arc(r - t, a, top + t)
        path.line((right, top + t)).close()
    elif name == "T":
        half = [(x, top), (x, top + t), (c - t / 2, top + t), (c - t / 2, base)]
        path.polygon(half + [(2 * c - a, b) for a, b in reversed(half)])
    elif name == "U":
        r = w / 2
        path.move(x, top).line((x + t, top), (x + t, base - r)).arc(r - t, right - t, base - r, False)
        path.line((right - t, top), (right, top), (right, base - r)).arc(r, x, base - r).close()
    else:
        raise ValueError(f"no letter {name}")
    return path
