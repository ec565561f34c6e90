"""Reads a line stream, rls (written from docs/rls.md) or ndjson, and prints its pixels: width and lines as a line of text,
then four bytes a pixel, big-endian: 0 for paper, ink + 1, or the colour + 1 of a shaded raster. Nothing of runset is used."""

import json
import sys
import zlib


def number():
    value = shift = 0
    while True:
        byte = data.pop()
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            return value


def take(count):
    return bytes(data.pop() for _ in range(count))


def rls():
    assert take(8) == bytes.fromhex("89524c530d0a1a0a")
    version, kind = number(), number()
    assert version == 1 and kind < 2
    width, start, stop = number(), number(), number()
    inks = take(3) if kind else [take(3) for _ in range(number())]
    rows, total = [], 0
    while n := number():
        row, end = [0] * width, 0
        count = number()
        for _ in range(count):
            begin = end + number()
            end = begin + number()
            ink = int.from_bytes(take(3), "big") if kind else number() if len(inks) > 1 else 0
            row[begin:end] = [ink + 1] * (end - begin)
        rows += [row] * n
        total += n * count
    assert (number(), number()) == (stop - start, total)
    return width, stop - start, inks, rows, int.from_bytes(take(4), "big")


def ndjson():
    header, *records, end = [json.loads(line) for line in text.decode().splitlines()]
    assert header["runset"] == 1 and header["height"] == header["to"] - header["from"]
    shaded = header["inks"] == "rgb"
    inks = bytes.fromhex(header["paper"][1:]) if shaded else header["inks"]
    rows, total = [], 0
    for record in records:
        assert record["y"] == header["from"] + len(rows)
        row = [0] * header["width"]
        for begin, stop, *ink in record["runs"]:
            ink = int(ink[0][1:], 16) if shaded else sum(ink)
            row[begin:stop] = [ink + 1] * (stop - begin)
        rows += [row] * record["n"]
        total += record["n"] * len(record["runs"])
    assert end["end"] is True and (end["lines"], end["runs"]) == (header["height"], total)
    return header["width"], header["height"], inks, rows, int(end["crc32"], 16)


def checked(row, inks):
    """A row as the checksum takes it; `inks` is a list, or the three bytes of a shaded raster's paper."""
    if isinstance(inks, bytes):
        return b"".join((pixel - 1).to_bytes(3, "big") if pixel else inks for pixel in row)
    if len(inks) < 2:
        bits = "".join(map(str, row)) + "0" * (-len(row) % 8)
        return bytes(int(bits[i : i + 8], 2) for i in range(0, len(bits), 8))
    return b"".join(pixel.to_bytes(1 if len(inks) < 256 else 2, "big") for pixel in row)


text = sys.stdin.buffer.read()
data = list(reversed(text))
width, height, inks, rows, crc = ndjson() if text.startswith(b"{") else rls()
assert not text.startswith(b"\x89") or not data
assert len(rows) == height
assert zlib.crc32(b"".join(checked(row, inks) for row in rows)) == crc
sys.stdout.buffer.write(b"%d %d\n" % (width, height))
sys.stdout.buffer.write(b"".join(pixel.to_bytes(4, "big") for row in rows for pixel in row))
