"""Images and algorithms measured: rows as structured arrays, with the columns of measurements.csv and targets.csv."""

from __future__ import annotations

import csv
import ctypes
import math
import os
import tempfile
from typing import Iterable, Optional, Union

import numpy as np

from . import native, own, scenes

MEASUREMENTS, TARGETS, FINDINGS = range(3)
TEXT, INTEGER, REAL = range(3)

Scenes = Union[scenes.Scene, str, Iterable[Union[scenes.Scene, str]]]
Results = Union[np.ndarray, np.void, str, os.PathLike]


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


def _filled(add, *kinds: int) -> list[np.ndarray]:
    table = native.make("table")
    try:
        add(table)
        return [_read(table, kind) for kind in kinds]
    finally:
        native.call("table_free", table)


def _measured(add) -> Rows:
    measurements, targets = _filled(add, MEASUREMENTS, TARGETS)
    rows = measurements.view(Rows)
    rows.targets = targets
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


def _scenes(asked: Scenes) -> list[scenes.Scene]:
    listed = [asked] if isinstance(asked, (scenes.Scene, str)) else list(asked)
    return [scenes.scene(s) if isinstance(s, str) else s for s in listed]


def run(
    scene: Scenes,
    algorithms: Union[str, own.Algorithm, Iterable[Union[str, own.Algorithm]]],
    timed: bool = True,
) -> Rows:
    """Measure algorithms, SPECs or those of one's own, on scenes, as `sasbench run`; returns a row for each pair.

    A refusal is a row as well: `status` "unsupported" or "failed", and the `reason`. `timed` False forms each image
    once, without times. The rows' attribute `targets` has those of the point targets. Nothing else should run
    meanwhile.
    """
    listed = _scenes(scene)
    asked = [algorithms] if isinstance(algorithms, (str, own.Algorithm)) else list(algorithms)

    def add(table):
        for s in listed:
            for a in asked:
                if isinstance(a, own.Algorithm):
                    a.measure(s, timed, table)
                else:
                    native.call("run", s._handle, native.encoded(a, "SPEC"), native.FLOAT, None, int(timed), table)

    return _measured(add)


def sweep(
    scene: Scenes,
    algorithms: Union[str, Iterable[str], None] = None,
    precision: Optional[str] = None,
    timed: bool = True,
) -> Rows:
    """Measure SPECs over their settings, as `sasbench sweep`: the rows of the exact image, then of each setting.

    algorithms: None is all. A setting that a SPEC names stays. precision: "float" or "double"; None is both. `timed` as
    of run. front(rows) draws error against run time.
    """
    listed = _scenes(scene)
    asked = scenes.algorithms() if algorithms is None else [algorithms] if isinstance(algorithms, str) else algorithms
    asked = list(asked)
    specs = (ctypes.c_char_p * len(asked))(*[native.encoded(a, "SPEC") for a in asked])
    which = None if precision is None else native.encoded(precision, "precision")

    def add(table):
        for s in listed:
            native.call("sweep", s._handle, len(asked), specs, which, int(timed), table)

    return _measured(add)


def _write(rows: Union[np.ndarray, np.void], folder: str, name: str) -> str:
    """As a file of the program, which has nine digits, and nothing for NaN and -1."""
    if not rows.dtype.names:
        raise native.Error(f"results: an array of {rows.dtype} has no columns; rows of run, or a path, are needed")
    kind = "targets" if "axis" in rows.dtype.names else "measurements"
    path = os.path.join(folder, name)
    with open(path, "w", newline="", encoding="utf-8", errors="surrogateescape") as file:
        file.write(f"# sasbench {kind} 1\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(rows.dtype.names)
        for row in np.atleast_1d(rows).tolist():
            whole = [v if isinstance(v, float) or v != -1 else math.nan for v in row]
            writer.writerow(["" if v != v else f"{v:.9g}" if isinstance(v, float) else v for v in whole])
    return path


def compare(old: Results, new: Results) -> np.ndarray:
    """What differs between two results, as `sasbench compare`: a row a finding.

    old, new: rows of run or sweep (or their `targets`), or the path of a results folder or of one of its CSV files. The
    rows have `verdict` (worse, gone, changed, better, new, same), class, scene, spec, detail, metric, unit, the values
    `before` and `after`, `change` (after/before - 1) and the `slack` within which values count as the same. Rows are
    matched by scene, algorithm, options and precision. Nothing is raised where something got worse.
    """
    with tempfile.TemporaryDirectory() as folder:
        old, new = (
            native.encoded(_write(side, folder, name) if isinstance(side, (np.ndarray, np.void)) else side, "results")
            for side, name in ((old, "old.csv"), (new, "new.csv"))
        )
        return _filled(lambda table: native.call("compare", old, new, table), FINDINGS)[0]
