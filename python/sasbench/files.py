"""Echo files (docs/echo_files.md), written by scipy, which is imported when the first one is."""

from __future__ import annotations

import math
import os
import tempfile
from typing import Sequence, Union

import numpy as np

from . import native, scenes


def _some_pixel(a: scenes.Acquisition) -> scenes.Grid:
    """A pixel that the first ping sees in the middle of its record; any, of shapes that make refuses."""
    x, y, z = np.resize(np.asarray(a.tx, dtype=np.float64), 3)
    away = a.sound_speed * (np.resize(a.t0, 1)[0] + a.samples / 2 / a.fs) / 2
    return scenes.Grid(x, 1, 1, y + math.sqrt(max(away**2 - z**2, 0)), 1, 1)


def _variables(a: scenes.Acquisition, echoes: np.ndarray, grids: Sequence[scenes.Grid], points) -> dict:
    found = {
        "format": "sas-echoes 1", "samples": np.transpose(echoes, (2, 1, 0)), "compressed": float(a.pulse is None),
        "fs": float(a.fs), "fc": float(a.fc), "bandwidth": float(a.bandwidth), "sound_speed": float(a.sound_speed),
        "t0": np.reshape(a.t0, (1, -1)).astype(np.float64), "tx": np.transpose(a.tx).astype(np.float64),
        "rx": np.transpose(a.rx, (2, 1, 0)).astype(np.float64), "velocity": np.transpose(a.velocity).astype(np.float64),
    }  # fmt: skip
    if a.pulse is not None:
        found["pulse"] = np.reshape(a.pulse, (-1, 1)).astype(np.complex128)
    for name, value in (("tx_length", a.tx_length), ("rx_length", a.rx_length)):
        if value != 0:
            found[name] = float(value)
    if a.aperture_limit <= 1:  # beyond, it leaves out nothing
        found["beam_limit"] = float(a.aperture_limit)
    if grids:
        found["image_grid"] = np.array(
            [[g.x_first, g.x_step, g.x_count, g.r_first, g.r_step, g.r_count, g.angle] for g in grids], dtype=np.float64
        ).T
    if len(points):
        found["point_targets"] = points.T
    return found


def save(
    path: Union[str, os.PathLike],
    acquisition: scenes.Acquisition,
    echoes: np.ndarray,
    grids: Union[scenes.Grid, Sequence[scenes.Grid]] = (),
    points=(),
) -> None:
    """Write an echo file, whose name ends in .mat, for `load` and the program; the arrays are those of `make`.

    grids: the image where readers ask for no other. The samples keep their precision. The file is checked; it is then
    whole, or as it was before. It is of version 5, so each variable must have less than 4 GiB.
    """
    try:
        import scipy.io
    except ImportError as error:
        raise native.Error("echo files are written by scipy: apt install python3-scipy, or pip install it") from error
    path = os.path.realpath(os.fsdecode(native.encoded(path, "file")))
    if not path.endswith(".mat"):
        raise native.Error(f"{path}: the name of an echo file must end in .mat")
    grids = [grids] if isinstance(grids, scenes.Grid) else list(grids)
    scenes.precision_of(np.asarray(echoes).dtype, "echoes")
    checked = grids or [_some_pixel(acquisition)]
    points = scenes.make(acquisition, checked, echoes, points).points
    try:
        with tempfile.TemporaryDirectory(prefix=".sasbench-", dir=os.path.dirname(path)) as folder:
            whole = os.path.join(folder, "echoes.mat")
            scipy.io.savemat(whole, _variables(acquisition, np.asarray(echoes), grids, points))
            try:
                scenes.load(whole, checked[0])
            except native.Error as error:
                raise type(error)(str(error).replace(whole, path), error.status) from None
            os.replace(whole, path)
    except OSError as error:
        raise native.Error(f"{path}: cannot be written: {error.strerror}") from error
    except scipy.io.matlab.MatWriteError as error:
        raise native.Error(f"{path}: cannot be written: a variable has 4 GiB or more") from error
