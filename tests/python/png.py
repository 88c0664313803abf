"""Reads the PNG files of sfumato: 8-bit RGB or RGBA, not interlaced."""
import struct
import zlib

import numpy as np


def read_png(file):
    """uint8 (height, width, 3 or 4)."""
    with open(file, "rb") as stream:
        data = stream.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, shape = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, color, _, _, interlaced = struct.unpack(">IIBBBBB", body)
            assert depth == 8 and color in (2, 6) and not interlaced
            shape = height, width, {2: 3, 6: 4}[color]
        packed += body if kind == b"IDAT" else b""
        at += 12 + size
    height, width, channels = shape
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * channels)
    out = np.zeros((height + 1, width + 1, channels), np.int64)  # a row above and a column to the left, for the filters
    for y in range(height):
        line = rows[y, 1:].reshape(width, channels).astype(np.int64)
        above = out[y]
        kind = rows[y, 0]
        if kind == 0:
            out[y + 1, 1:] = line
        elif kind == 1:
            out[y + 1, 1:] = np.cumsum(line, axis=0) % 256
        elif kind == 2:
            out[y + 1, 1:] = (line + above[1:]) % 256
        else:
            for x in range(width):
                a, b, c = out[y + 1, x], above[x + 1], above[x]
                if kind == 3:
                    guess = (a + b) // 2
                else:  # Paeth
                    p = a + b - c
                    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                    guess = np.where((pa <= pb) & (pa <= pc), a, np.where(pb <= pc, b, c))
                out[y + 1, x + 1] = (line[x] + guess) % 256
    return out[1:, 1:].astype(np.uint8)
