"""Results of the simulator openSTB as echo files: its result converter `EchoFile:sasbench.openstb`.

    [result_converter]
    name = "EchoFile:sasbench.openstb"
    filename = "echoes.mat"
    depth = 10

Written after openSTB's plugin interface, which needs no base class; openSTB itself is not imported.
"""

from __future__ import annotations

import os
from typing import Optional, Sequence, Union

import numpy as np

from . import files, native, scenes

_FORMAT = "ZARR_BASEBAND_PRESSURE"


def _rotated(quaternions, vectors: np.ndarray) -> np.ndarray:
    """Vectors [N, 3] turned by each quaternion [P, 4], scalar first: [P, N, 3]."""
    q = np.asarray(getattr(quaternions, "ndarray", quaternions), dtype=np.float64)[:, None, :]
    w, u = q[..., :1], q[..., 1:]
    return vectors + 2 * np.cross(u, w * vectors + np.cross(u, vectors)) / np.sum(q**2, axis=-1, keepdims=True)


def _upwards(positions: np.ndarray, depth: float) -> np.ndarray:
    """z up from the image plane; openSTB's points down. Delays are the same in the mirrored space."""
    return positions * [1, 1, -1] + [0, 0, depth]


def _sound_speed(config, pings: np.ndarray) -> float:
    """That of the emissions, which openSTB's travel times take."""
    trajectory, environment = config["trajectory"], config["environment"]
    speeds = np.broadcast_to(environment.sound_speed(pings, trajectory.position(pings)), pings.shape)
    if not np.ptp(speeds) <= 1e-9 * np.max(speeds):
        raise native.Error(
            f"environment: the sound speed is {np.min(speeds):.9g} to {np.max(speeds):.9g} m/s along the track; "
            "one speed is needed"
        )
    return float(speeds[0])


def _velocity(config, pings: np.ndarray, reception: float) -> np.ndarray:
    """[P, 3] m/s from emission to `reception` s later, or at emission where the trajectory ends before that."""
    trajectory = config["trajectory"]
    if type(config["travel_time"]).__name__ == "StopAndHop":
        return np.zeros((len(pings), 3))
    mean = (trajectory.position(pings + reception) - trajectory.position(pings)) / reception
    return np.where(np.isfinite(mean), mean, trajectory.velocity(pings))


def acquisition(result, config, depth: float, tx_length: float = 0.0, rx_length: float = 0.0) -> scenes.Acquisition:
    """The recording of a result and its configuration, which `EchoFile` has; the system is in the latter's parts.

    Its carrier is the middle of the signal's band, to which `echoes` moves the samples.
    """
    signal, trajectory = config["signal"], config["trajectory"]
    pings, times = np.asarray(result["ping_start_time"][:]), np.asarray(result["sample_time"][:])
    if len(times) < 2:
        raise native.Error(f"sample_time: has {len(times)} samples; 2 are needed")
    fs = (len(times) - 1) / (times[-1] - times[0])
    fc = (signal.minimum_frequency + signal.maximum_frequency) / 2
    t = np.arange(int(signal.duration * fs) + 1) / fs
    vehicle, turned = trajectory.position(pings), trajectory.orientation(pings)
    receivers = np.array([r.position for r in config["receivers"]], dtype=np.float64)
    velocity = _velocity(config, pings, times[len(times) // 2])
    return scenes.Acquisition(
        samples=len(times), sound_speed=_sound_speed(config, pings), fc=fc, fs=fs,
        bandwidth=signal.maximum_frequency - signal.minimum_frequency, t0=np.full(len(pings), times[0]),
        tx=_upwards(vehicle + _rotated(turned, np.asarray(config["transmitter"].position)[None])[:, 0], depth),
        rx=_upwards(vehicle[:, None] + _rotated(turned, receivers), depth), velocity=velocity * [1, 1, -1],
        pulse=signal.sample(t, fc), tx_length=tx_length, rx_length=rx_length,
    )  # fmt: skip


def echoes(result, acquisition: scenes.Acquisition) -> np.ndarray:
    """The samples [pings, receivers, samples] at the acquisition's carrier."""
    pressure, times = np.asarray(result["pressure"][:], dtype=np.complex128), np.asarray(result["sample_time"][:])
    return pressure * np.exp(-2j * np.pi * (acquisition.fc - result.attrs["baseband_frequency"]) * times)


class EchoFile:
    """A result converter that writes an echo file (docs/echo_files.md).

    filename: ends in .mat, and is not there yet. depth: z (m) of the plane that is imaged, which points down as in
    openSTB; x and y are openSTB's, and y is the image's r. The track should run along x. grid: the image, if known
    before: first x, step and count, first r, step and count (m). tx_length, rx_length: of the elements along the track
    (m), which range migration needs; 0: not known.
    """

    def __init__(
        self,
        filename: Union[str, os.PathLike],
        depth: float,
        grid: Optional[Sequence[float]] = None,
        tx_length: float = 0.0,
        rx_length: float = 0.0,
    ):
        self.filename, self.depth, self.tx_length, self.rx_length = filename, depth, tx_length, rx_length
        if not os.fspath(filename).endswith(".mat") or os.path.exists(filename):
            raise native.Error(f"filename is {os.fspath(filename)!r}, must end in .mat and not be there yet")
        if not np.isfinite(depth):
            raise native.Error(f"depth is {depth!r}; a finite number of metres is needed")
        if grid is not None and len(grid) != 6:
            raise native.Error(f"grid has {len(grid)} numbers, must have 6: first x, step, count, first r, step, count")
        self.grids = [] if grid is None else [scenes.Grid(*grid)]

    def can_handle(self, format, config) -> bool:
        """Before the simulation. Errors: a sound speed that varies."""
        if getattr(format, "name", format) != _FORMAT:
            return False
        _sound_speed(config, np.asarray(config["ping_times"].calculate(config["trajectory"])))
        return True

    def convert(self, format, result, config) -> bool:
        """True: the file is written, whole. Where it raises an error, openSTB keeps the result."""
        if getattr(format, "name", format) != _FORMAT:
            return False
        made = acquisition(result, config, self.depth, self.tx_length, self.rx_length)
        files.save(self.filename, made, echoes(result, made), self.grids)
        return True
