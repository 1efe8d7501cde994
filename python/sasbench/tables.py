"""Images and algorithms measured: rows as structured arrays, with the columns of measurements.csv and targets.csv."""

from __future__ import annotations

import ctypes
import math
from typing import Iterable, Optional, Union

import numpy as np

from . import native, own, scenes

MEASUREMENTS, TARGETS = range(2)
TEXT, INTEGER, REAL = range(3)


class Rows(np.ndarray):
    """A structured array; `targets` has the rows of the point targets, several for each."""

    targets: np.ndarray

    def __array_finalize__(self, source):
        self.targets = getattr(source, "targets", None)


def _columns(kind: int) -> list[tuple[str, int]]:
    columns: list[tuple[str, int]] = []
    type_ = ctypes.c_int()
    while name := native.call("column", kind, len(columns), ctypes.byref(type_)):
        columns.append((native.text(name), type_.value))
    return columns


def _read(table, kind: int) -> np.ndarray:
    """Text columns are as wide as their longest text; an empty integer is -1, an empty real number NaN."""
    columns, count = _columns(kind), native.call("table_count", table, kind)
    cells, types = [], []
    for k, (name, type_) in enumerate(columns):
        if type_ == TEXT:
            cells.append([native.text(native.call("table_text", table, kind, n, k)) for n in range(count)])
            types.append((name, f"U{max(map(len, cells[-1]), default=0) or 1}"))
        else:
            numbers = [native.call("table_number", table, kind, n, k) for n in range(count)]
            cells.append([-1 if math.isnan(v) else int(v) for v in numbers] if type_ == INTEGER else numbers)
            types.append((name, "i8" if type_ == INTEGER else "f8"))
    rows = np.zeros(count, types)
    for (name, _), values in zip(columns, cells):
        rows[name] = values
    return rows


def _measured(add) -> Rows:
    table = native.make("table")
    try:
        add(table)
        rows = _read(table, MEASUREMENTS).view(Rows)
        rows.targets = _read(table, TARGETS)
    finally:
        native.call("table_free", table)
    return rows


def score(scene: scenes.Scene, image: scenes.Image, name: str = "image", seconds: Optional[float] = None) -> np.void:
    """Measure an image [rows, columns] that another program formed on the scene's grid, as `sasbench score`.

    Returns one row: error, error_gain, width_m, pslr_db, islr_db and the other columns of measurements.csv.
    `seconds`: what it took, if known. targets(scene, image) has the rows of its point targets.
    """
    return _scored(scene, image, name, seconds)[0]


def targets(scene: scenes.Scene, image: scenes.Image) -> np.ndarray:
    """The rows of the image's point targets: extent, width, lobes and position error along each axis."""
    return _scored(scene, image, "image", None).targets


def _scored(scene: scenes.Scene, image: scenes.Image, name: str, seconds: Optional[float]) -> Rows:
    images = scenes.as_list(scene, image)
    precision = scenes.precision_of(images[0].dtype, "image")
    time = math.nan if seconds is None else seconds
    encoded = native.encoded(name, "name")
    return _measured(
        lambda t: native.call("score", scene._handle, encoded, precision, scenes.pointers(images), time, t)
    )


def run(
    scene: Union[scenes.Scene, str, Iterable[Union[scenes.Scene, str]]],
    algorithms: Union[str, own.Algorithm, Iterable[Union[str, own.Algorithm]]],
    timed: bool = True,
) -> Rows:
    """Measure algorithms, SPECs or those of one's own, on scenes, as `sasbench run`; returns a row for each pair.

    A refusal is a row as well: `status` "unsupported" or "failed", and the `reason`. `timed` False forms each image
    once, without times. The rows' attribute `targets` has those of the point targets. Nothing else should run
    meanwhile.
    """
    listed = [scene] if isinstance(scene, (scenes.Scene, str)) else list(scene)
    listed = [scenes.scene(s) if isinstance(s, str) else s for s in listed]
    asked = [algorithms] if isinstance(algorithms, (str, own.Algorithm)) else list(algorithms)

    def add(table):
        for s in listed:
            for a in asked:
                if isinstance(a, own.Algorithm):
                    a.measure(s, timed, table)
                else:
                    native.call("run", s._handle, native.encoded(a, "SPEC"), native.FLOAT, None, int(timed), table)

    return _measured(add)
