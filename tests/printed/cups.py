"""Reads files of PWG raster or Apple raster by libcups, and prints their pages: a line of numbers and the name of the size, then the pixels as bytes.

    width height bits-per-colour bits-per-pixel bytes-per-line colour-order colour-space colours dpi-x dpi-y points-x points-y pages
    cross-feed feed left top right bottom hundredths-of-mm-x hundredths-of-mm-y name

The last but the name are the size that libcups knows for the name, 0 where there is no name. Behind a file's pages stands a line `end`."""

import ctypes
import os
import struct
import sys

cups = ctypes.CDLL("libcups.so.2")
cups.cupsRasterOpen.restype = ctypes.c_void_p
cups.cupsRasterErrorString.restype = ctypes.c_char_p
cups.cupsRasterReadHeader2.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
cups.cupsRasterReadPixels.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint]
cups.cupsRasterClose.argtypes = [ctypes.c_void_p]


class Media(ctypes.Structure):
    _fields_ = [("pwg", ctypes.c_char_p), ("legacy", ctypes.c_char_p), ("ppd", ctypes.c_char_p), ("width", ctypes.c_int), ("length", ctypes.c_int)]


cups.pwgMediaForPWG.restype = ctypes.POINTER(Media)
OFFSETS = [372, 376, 384, 388, 392, 396, 400, 420, 276, 280, 352, 356, 452, 456, 460, 464, 468, 472, 476]

for path in sys.argv[1:]:
    file = os.open(path, os.O_RDONLY)
    raster = cups.cupsRasterOpen(file, 0)
    assert raster, f"{path}: not a raster"
    header = ctypes.create_string_buffer(1796)
    while cups.cupsRasterReadHeader2(raster, header):
        numbers = [struct.unpack_from("=I", header, at)[0] for at in OFFSETS]
        name = header[1732:1796].split(b"\0")[0]
        media = cups.pwgMediaForPWG(name) if name else None
        numbers += [media.contents.width, media.contents.length] if media else [0, 0]
        sys.stdout.buffer.write(" ".join(map(str, numbers)).encode() + b" " + name + b"\n")
        row = ctypes.create_string_buffer(numbers[4])
        for y in range(numbers[1]):
            assert cups.cupsRasterReadPixels(raster, row, numbers[4]) == numbers[4], f"{path}: line {y}: {cups.cupsRasterErrorString()}"
            sys.stdout.buffer.write(row.raw)
    cups.cupsRasterClose(raster)
    assert os.lseek(file, 0, os.SEEK_CUR) == os.fstat(file).st_size, f"{path}: something follows the last page"
    os.close(file)
    sys.stdout.buffer.write(b"end\n")
