"""Variables of a MATLAB file of version 5, as this program writes them: numbers alone."""

import struct
import zlib

import numpy as np

TYPES = {1: "i1", 2: "u1", 3: "<i2", 4: "<u2", 5: "<i4", 6: "<u4", 7: "<f4", 9: "<f8", 16: "u1"}


def elements(data):
    while data:
        kind, length = struct.unpack_from("<II", data)
        small = kind >> 16  # four bytes at most lie in the tag itself
        yield (kind & 0xFFFF, data[4 : 4 + small]) if small else (kind, data[8 : 8 + length])
        data = data[8:] if small else data[8 + length + (-length % 8 if kind != 15 else 0) :]


def variables(path):
    found = {}
    with open(path, "rb") as file:
        data = file.read()[128:]
    for kind, body in elements(data):
        parts = list(elements(next(elements(zlib.decompress(body)))[1] if kind == 15 else body))
        flags, dims = struct.unpack_from("<I", parts[0][1])[0], np.frombuffer(parts[1][1], "<i4")
        if len(parts) < 4:  # empty
            continue
        numbers = [np.frombuffer(p[1], TYPES[p[0]]) for p in parts[3:]]
        values = numbers[0] + 1j * numbers[1] if flags & 0x800 else numbers[0]
        values = values.astype(np.complex64) if flags & 0x800 and flags & 0xFF == 7 else values
        found[parts[2][1].decode()] = values.reshape(dims, order="F")
    return found
