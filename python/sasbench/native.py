"""libsasbench by ctypes: its structs and functions, and its errors as exceptions (libsasbench.h describes each)."""

from __future__ import annotations

import ctypes
import os
import pathlib
import threading
from ctypes import CFUNCTYPE, POINTER, byref, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t, c_uint32, c_void_p

OK, FAILED, INVALID, UNSUPPORTED = range(4)
FLOAT, DOUBLE = range(2)


class Error(RuntimeError):
    """What failed, in one line: place, value and what is accepted. `status` is 1 (failed), 2 (invalid) or 3."""

    def __init__(self, message: str, status: int = INVALID):
        super().__init__(message)
        self.status = status


class Unsupported(Error):
    """Legal input that an algorithm cannot image: the message is the reason. Algorithms of one's own may raise it."""

    def __init__(self, message: str):
        super().__init__(message, UNSUPPORTED)


class Struct(ctypes.Structure):
    """A struct that begins with its size."""

    def __init__(self, *values, **fields):
        super().__init__(ctypes.sizeof(type(self)), *values, **fields)


class Acquisition(Struct):
    _fields_ = [
        ("size", c_uint32), ("pings", c_int32), ("receivers", c_int32), ("samples", c_int32),
        ("sound_speed", c_double), ("fc", c_double), ("fs", c_double), ("bandwidth", c_double),
        ("t0", POINTER(c_double)), ("tx", POINTER(c_double)), ("rx", POINTER(c_double)),
        ("velocity", POINTER(c_double)), ("tx_length", c_double), ("rx_length", c_double),
        ("aperture_limit", c_double), ("pulse_length", c_int32), ("pulse", POINTER(c_double)),
    ]  # fmt: skip


class Grid(Struct):
    _fields_ = [
        ("size", c_uint32), ("x_count", c_int32), ("r_count", c_int32),
        ("x_first", c_double), ("x_step", c_double), ("r_first", c_double), ("r_step", c_double), ("angle", c_double),
    ]  # fmt: skip


class Arrays(Struct):
    _fields_ = [
        ("size", c_uint32), ("name", c_char_p), ("acquisition", POINTER(Acquisition)),
        ("patch_count", c_int32), ("point_count", c_int32), ("patches", POINTER(Grid)),
        ("points", POINTER(c_double)), ("samples", c_void_p),
    ]  # fmt: skip


class Setting(Struct):
    _fields_ = [
        ("size", c_uint32), ("kind", c_int32), ("name", c_char_p), ("summary", c_char_p),
        ("initial", c_double), ("min", c_double), ("max", c_double),
        ("names", POINTER(c_char_p)), ("text", c_char_p), ("sweep", c_char_p),
    ]  # fmt: skip


class Host(ctypes.Structure):
    """The functions that an algorithm of one's own calls; the others by their place alone."""

    _fields_ = [
        ("size", c_uint32), ("abi", c_uint32), ("pair", c_void_p), ("place", c_void_p), ("pairs", c_void_p),
        ("compress", c_void_p), ("compress_flops", c_void_p), ("store", c_void_p),
        ("stage", CFUNCTYPE(None, c_void_p, c_char_p)),
        ("fail", CFUNCTYPE(c_int, c_int, c_char_p, c_char_p)),
    ]  # fmt: skip


class Problem(ctypes.Structure):
    _fields_ = [
        ("size", c_uint32), ("precision", c_int32), ("acquisition", c_void_p), ("pixels", c_int64),
        ("patch_count", c_int32), ("threads", c_int32), ("patches", c_void_p), ("numbers", c_void_p),
        ("texts", c_void_p), ("host", POINTER(Host)),
    ]  # fmt: skip


PLAN = CFUNCTYPE(c_int, POINTER(Problem), POINTER(c_void_p))
EXECUTE = CFUNCTYPE(c_int, c_void_p, c_void_p, POINTER(c_void_p), c_void_p)
WORK = CFUNCTYPE(None, c_void_p, c_void_p)
DESTROY = CFUNCTYPE(None, c_void_p)


class Algorithm(Struct):
    _fields_ = [
        ("size", c_uint32), ("abi", c_uint32), ("summary", c_char_p), ("reference", c_char_p),
        ("traits", c_uint32), ("setting_count", c_uint32), ("settings", c_void_p),
        ("plan", PLAN), ("execute", EXECUTE), ("work", WORK), ("destroy", DESTROY),
    ]  # fmt: skip


ABI = 1  # the first header that has all of Algorithm

FUNCTIONS = {
    "version": (c_char_p, []),
    "message": (c_char_p, []),
    "interruptible": (None, []),
    "open": (c_int, [c_int, c_char_p, POINTER(c_void_p)]),
    "algorithm": (c_char_p, [c_int, POINTER(c_char_p), POINTER(c_char_p)]),
    "setting": (c_int, [c_int, c_int, POINTER(Setting)]),
    "scene_load": (c_int, [c_void_p, c_char_p, POINTER(c_void_p)]),
    "scene_read": (c_int, [c_void_p, c_char_p, POINTER(Grid), POINTER(c_void_p)]),
    "scene_make": (c_int, [c_void_p, POINTER(Arrays), POINTER(c_void_p)]),
    "scene_arrays": (POINTER(Arrays), [c_void_p]),
    "scene_free": (None, [c_void_p]),
    "echoes": (c_int, [c_void_p, c_int, c_void_p]),
    "forward": (c_int, [c_void_p, POINTER(c_void_p), c_void_p]),
    "adjoint": (c_int, [c_void_p, c_void_p, POINTER(c_void_p)]),
    "delays": (c_int, [c_void_p, c_size_t, c_void_p, c_void_p]),
    "plan": (c_int, [c_void_p, c_char_p, c_int, POINTER(c_void_p)]),
    "plan_precision": (c_int, [c_void_p]),
    "execute": (c_int, [c_void_p, c_int, c_void_p, POINTER(c_void_p)]),
    "plan_free": (None, [c_void_p]),
    "table": (c_int, [POINTER(c_void_p)]),
    "table_free": (None, [c_void_p]),
    "column": (c_char_p, [c_int, c_int, POINTER(c_int)]),
    "table_count": (c_int, [c_void_p, c_int]),
    "table_text": (c_char_p, [c_void_p, c_int, c_int, c_int]),
    "table_number": (c_double, [c_void_p, c_int, c_int, c_int]),
    "score": (c_int, [c_void_p, c_char_p, c_int, POINTER(c_void_p), c_double, c_void_p]),
    "run": (c_int, [c_void_p, c_char_p, c_int, POINTER(Algorithm), c_int, c_void_p]),
    "sweep": (c_int, [c_void_p, c_int, POINTER(c_char_p), c_char_p, c_int, c_void_p]),
    "compare": (c_int, [c_char_p, c_char_p, c_void_p]),
}

# Those that return a status.
STATUSES = {name for name, (result, _) in FUNCTIONS.items() if result is c_int} - {
    "setting", "plan_precision", "table_count",
}  # fmt: skip


def _load() -> ctypes.CDLL:
    """The library of SASBENCH_LIBRARY, the one beside this module, or the system's."""
    # As the program does, which its images' times assume: waiting threads leave the processor to others.
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    beside = pathlib.Path(__file__).resolve().with_name("libsasbench.so")
    path = os.environ.get("SASBENCH_LIBRARY") or (str(beside) if beside.exists() else "libsasbench.so.1")
    library = ctypes.CDLL(path)
    for name, (result, arguments) in FUNCTIONS.items():
        function = getattr(library, "sasbench_" + name)
        function.restype, function.argtypes = result, arguments
    if threading.current_thread() is threading.main_thread():  # which has Python's signals
        library.sasbench_interruptible()
    return library


_library = _load()


def call(name: str, *arguments):
    """Call sasbench_NAME; a status that is not OK raises Error with the library's message."""
    result = getattr(_library, "sasbench_" + name)(*arguments)
    if name in STATUSES and result != OK:
        message = text(_library.sasbench_message())
        raise Unsupported(message) if result == UNSUPPORTED else Error(message, result)
    return result


def make(name: str, *arguments) -> c_void_p:
    """The same of a function that makes what its last argument points to."""
    made = c_void_p()
    call(name, *arguments, byref(made))
    return made


def text(raw: bytes | None) -> str:
    return (raw or b"").decode("utf-8", "surrogateescape")


def encoded(name: str | os.PathLike, what: str) -> bytes:
    """A path or a SPEC for C, which ends texts at a zero."""
    raw = os.fsencode(name)
    if b"\0" in raw:
        raise Error(f"{what} {raw[:100]!r} has a zero in it; a text without one is needed")
    return raw
