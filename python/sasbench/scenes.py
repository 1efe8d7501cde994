"""Scenes, their echoes, and images of them."""

from __future__ import annotations

import ctypes
import dataclasses
import os
import weakref
from ctypes import POINTER, byref, c_char_p, c_double, c_void_p
from typing import Optional, Sequence, Union

import numpy as np

from . import native

Image = Union[np.ndarray, "list[np.ndarray]"]
_PRECISIONS = {np.dtype(np.complex64): native.FLOAT, np.dtype(np.complex128): native.DOUBLE}
_DTYPES = {native.FLOAT: np.dtype(np.complex64), native.DOUBLE: np.dtype(np.complex128)}
_context: Optional[c_void_p] = None


def version() -> str:
    """The library's version."""
    return native.text(native.call("version"))


def threads(count: int) -> None:
    """Scenes that are made from now on use so many threads; 0: as many as OpenMP takes, OMP_NUM_THREADS."""
    global _context
    _context = native.make("open", _whole(count, "threads"), None)


def _opened() -> c_void_p:
    if _context is None:
        threads(0)
    return _context


def _whole(value, what: str) -> int:
    """A number that fits C's int."""
    try:
        number = int(value)
    except (TypeError, ValueError, OverflowError):
        number = None
    if number is None or number != value or not -(2**31) <= number < 2**31:
        raise native.Error(f"{what} is {value!r}; a whole number is needed")
    return number


def precision_of(dtype, what: str) -> int:
    dtype = np.dtype(dtype)
    if dtype not in _PRECISIONS:
        raise native.Error(f"{what}: {dtype} is no dtype of them; complex64 and complex128 are accepted")
    return _PRECISIONS[dtype]


def checked(array, shape: Sequence[int], what: str) -> np.ndarray:
    """A contiguous array, without a copy where it is one."""
    array = np.asarray(array)
    precision_of(array.dtype, what)
    if array.shape != tuple(shape):
        raise native.Error(f"{what}: the shape is {array.shape}, must be {tuple(shape)}")
    return np.ascontiguousarray(array)


@dataclasses.dataclass(frozen=True)
class Grid:
    """Pixels [r_count, x_count] at x = x_first + j x_step, r = r_first + i r_step (m), in axes turned by `angle`."""

    x_first: float
    x_step: float
    x_count: int
    r_first: float
    r_step: float
    r_count: int
    angle: float = 0.0  # rad

    @property
    def shape(self) -> tuple[int, int]:
        return self.r_count, self.x_count

    @property
    def x(self) -> np.ndarray:
        """[x_count] m, of the turned axes."""
        return self.x_first + np.arange(self.x_count) * self.x_step

    @property
    def r(self) -> np.ndarray:
        """[r_count] m, of the turned axes."""
        return self.r_first + np.arange(self.r_count) * self.r_step

    def points(self) -> np.ndarray:
        """[r_count, x_count, 3] m: x, y, z of the pixels in the track's axes."""
        r, x = np.meshgrid(self.r, self.x, indexing="ij")
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.stack([x * c + r * s, r * c - x * s, np.zeros_like(x)], axis=-1)

    def _struct(self) -> native.Grid:
        return native.Grid(
            _whole(self.x_count, "x_count"), _whole(self.r_count, "r_count"),
            self.x_first, self.x_step, self.r_first, self.r_step, self.angle,
        )  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Acquisition:
    """The recording without its samples. P pings, N receivers; x along the track, y across it."""

    samples: int  # of a record
    sound_speed: float  # m/s
    fc: float  # Hz, carrier; echoes turn by exp(-2j pi fc delay)
    fs: float  # Hz, sampling of the complex baseband
    bandwidth: float  # Hz
    t0: np.ndarray  # [P] s, each record's first sample after its emission
    tx: np.ndarray  # [P, 3] m, the transmitter at emission
    rx: np.ndarray  # [P, N, 3] m, the receivers at emission
    velocity: np.ndarray  # [P, 3] m/s, of the receivers until reception
    pulse: Optional[np.ndarray] = None  # [K] complex replica at fs, from emission on; None: the echoes are compressed
    tx_length: float = 0.0  # m, of elements along the track; 0: not known
    rx_length: float = 0.0
    aperture_limit: float = np.inf  # sine up to which pairs are summed
    scene: Optional["Scene"] = dataclasses.field(default=None, repr=False, compare=False)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Of the echoes: pings, receivers, samples."""
        return len(self.tx), self.rx.shape[1], self.samples

    def delay(self, points) -> np.ndarray:
        """Exact two-way delays (s) [P, N, ...] of points [..., 3] (m), without the stop-and-hop approximation."""
        if self.scene is None:
            raise native.Error("delay: this acquisition belongs to no scene; Scene.acquisition does")
        points = np.ascontiguousarray(points, dtype=np.float64)
        if points.ndim == 0 or points.shape[-1] != 3:
            raise native.Error(f"delay: the points' shape is {points.shape}, must end in 3 (x, y, z)")
        delays = np.empty(self.shape[:2] + points.shape[:-1])
        native.call("delays", self.scene._handle, points.size // 3, points.ctypes.data, delays.ctypes.data)
        return delays

    def compress(self, echoes: np.ndarray) -> np.ndarray:
        """Range-compressed echoes [P, N, samples]: a unit target peaks at 1. Compressed ones as they are."""
        if self.pulse is None:
            return echoes
        length = self.samples + len(self.pulse)
        replica = np.conj(np.fft.fft(self.pulse, length)) / np.sum(np.abs(self.pulse) ** 2)
        return np.fft.ifft(np.fft.fft(echoes, length) * replica)[..., : self.samples].astype(echoes.dtype)


def _array(pointer, shape: Sequence[int]) -> np.ndarray:
    count = int(np.prod(shape))
    return np.ctypeslib.as_array(pointer, (count,)).reshape(shape).copy() if count else np.zeros(shape)


class _Owner:
    """What the memory of a scene ends with: plans keep it, as Python may end a plan and its scene in either order."""


class Scene:
    """A recording, the image that is made of it, and its point targets. Made by scene, load and make.

    name: str; acquisition: Acquisition; grids: tuple of Grid, one a patch; points: [n, 4] x, r (m), and the amplitude's
    real and imaginary part.
    """

    def __init__(self, handle: c_void_p, context: c_void_p):
        self._handle, self._context = handle, context
        self._owner = _Owner()
        weakref.finalize(self._owner, native.call, "scene_free", handle)
        arrays = native.call("scene_arrays", handle).contents
        a = arrays.acquisition.contents
        pulse = _array(a.pulse, (2 * a.pulse_length,)).view(np.complex128) if a.pulse_length else None
        self.name: str = native.text(arrays.name)
        self._acquisition = Acquisition(
            a.samples, a.sound_speed, a.fc, a.fs, a.bandwidth, _array(a.t0, (a.pings,)), _array(a.tx, (a.pings, 3)),
            _array(a.rx, (a.pings, a.receivers, 3)), _array(a.velocity, (a.pings, 3)), pulse, a.tx_length, a.rx_length,
            a.aperture_limit,
        )  # fmt: skip
        self.grids: tuple[Grid, ...] = tuple(
            Grid(g.x_first, g.x_step, g.x_count, g.r_first, g.r_step, g.r_count, g.angle)
            for g in arrays.patches[: arrays.patch_count]
        )
        self.points: np.ndarray = _array(arrays.points, (arrays.point_count, 4))

    @property
    def acquisition(self) -> Acquisition:
        return dataclasses.replace(self._acquisition, scene=self)

    @property
    def grid(self) -> Grid:
        """Of the only patch."""
        if len(self.grids) != 1:
            raise native.Error(f"{self.name}: has {len(self.grids)} patches; `grids` has them")
        return self.grids[0]

    def __repr__(self) -> str:
        p, n, samples = self._acquisition.shape
        pixels = " + ".join(f"{g.r_count} x {g.x_count}" for g in self.grids)
        return f"<sasbench.Scene {self.name}: {p} pings, {n} receivers, {samples} samples; {pixels} pixels>"


def _made(function: str, *arguments) -> Scene:
    context = _opened()
    return Scene(native.make(function, context, *arguments), context)


def scene(name: Union[str, os.PathLike]) -> Scene:
    """A shipped scene by its name, "study/quick", or one by the path of its .cfg file."""
    return _made("scene_load", native.encoded(name, "scene"))


def load(path: Union[str, os.PathLike], grid: Optional[Grid] = None) -> Scene:
    """The echoes of a MATLAB file (docs/echo_files.md), imaged on `grid`, or on the file's own."""
    return _made("scene_read", native.encoded(path, "file"), byref(grid._struct()) if grid is not None else None)


def make(
    acquisition: Acquisition,
    grids: Union[Grid, Sequence[Grid]],
    echoes: Optional[np.ndarray] = None,
    points=(),
    name: str = "arrays",
) -> Scene:
    """A scene of arrays, which are copied.

    echoes: [P, N, samples] complex; None: they are simulated, of `points`, seen from everywhere alike;
    without points only images of echoes that are given, and delays, are made. points: [n, 4]
    x, r (m), and the amplitude's real and imaginary part; with echoes, those that are measured.
    """
    kept = []

    def put(values, shape, what, dtype=np.float64):
        array = np.ascontiguousarray(values, dtype=dtype)
        if array.shape != tuple(shape):
            raise native.Error(f"{what}: the shape is {array.shape}, must be {tuple(shape)}")
        kept.append(array)
        return array.ctypes.data_as(POINTER(c_double))

    a, tx, rx = acquisition, np.shape(acquisition.tx), np.shape(acquisition.rx)
    if len(tx) != 2 or len(rx) != 3:
        raise native.Error(f"tx and rx: the shapes are {tx} and {rx}, must be [pings, 3] and [pings, receivers, 3]")
    pings, receivers, samples = tx[0], rx[1], _whole(a.samples, "samples")
    pulse = np.zeros(0) if a.pulse is None else np.asarray(a.pulse)
    struct = native.Acquisition(
        pings, receivers, samples, a.sound_speed, a.fc, a.fs, a.bandwidth, put(a.t0, (pings,), "t0"),
        put(a.tx, (pings, 3), "tx"), put(a.rx, (pings, receivers, 3), "rx"), put(a.velocity, (pings, 3), "velocity"),
        a.tx_length, a.rx_length, a.aperture_limit, pulse.size, put(pulse, (pulse.size,), "pulse", np.complex128),
    )  # fmt: skip
    grids = [grids] if isinstance(grids, Grid) else list(grids)
    points = np.asarray(points, dtype=np.float64)
    points = points.reshape(-1, 4) if points.size == 0 or points.shape == (4,) else points
    if points.ndim != 2:
        raise native.Error(f"points: the shape is {points.shape}, must be [n, 4]")
    if echoes is not None:
        echoes = checked(echoes, (pings, receivers, samples), "echoes").astype(np.complex128, copy=False)
    arrays = native.Arrays(
        native.encoded(name, "name"), ctypes.pointer(struct), len(grids), len(points),
        (native.Grid * max(len(grids), 1))(*[g._struct() for g in grids]), put(points, (len(points), 4), "points"),
        None if echoes is None else echoes.ctypes.data,
    )  # fmt: skip
    return _made("scene_make", byref(arrays))


def simulate(scene: Scene, dtype=np.complex128) -> np.ndarray:
    """The scene's echoes [pings, receivers, samples], simulated as by `sasbench simulate`, or recorded."""
    echoes = np.empty(scene._acquisition.shape, dtype)
    native.call("echoes", scene._handle, precision_of(dtype, "simulate"), echoes.ctypes.data)
    return echoes


def pointers(images: Sequence[np.ndarray]):
    return (c_void_p * len(images))(*[i.ctypes.data for i in images])


def as_list(scene: Scene, image: Image) -> list[np.ndarray]:
    """The patches of an image, checked, of one dtype."""
    images = [image] if isinstance(image, np.ndarray) else list(image)
    if len(images) != len(scene.grids):
        raise native.Error(f"{scene.name}: the image has {len(images)} patches, must have {len(scene.grids)}")
    images = [checked(i, g.shape, "image") for i, g in zip(images, scene.grids)]
    dtype = np.result_type(*images)
    return [i.astype(dtype, copy=False) for i in images]


def _plan_free(handle: c_void_p, owner: _Owner) -> None:
    native.call("plan_free", handle)


class Plan:
    """All of an image's work that depends on geometry and settings only; execute forms the image of echoes.

    scene: Scene; spec: str; dtype: of its images.
    """

    def __init__(self, scene: Scene, spec: str, dtype=np.complex64):
        self.scene, self.spec = scene, spec
        precision = precision_of(dtype, "plan")
        self._handle = native.make("plan", scene._handle, native.encoded(spec, "SPEC"), precision)
        weakref.finalize(self, _plan_free, self._handle, scene._owner)
        self.dtype = _DTYPES[native.call("plan_precision", self._handle)]

    def execute(self, echoes: np.ndarray, out: Optional[Image] = None) -> Image:
        """The image [rows, columns] of echoes [pings, receivers, samples]; into `out` if given, which is C-contiguous.

        Plans execute side by side in several threads; one plan forms one image at a time.
        """
        echoes = checked(echoes, self.scene._acquisition.shape, "echoes")
        if out is None:
            images = [np.empty(g.shape, self.dtype) for g in self.scene.grids]
        else:
            images = as_list(self.scene, out)
            given = [out] if isinstance(out, np.ndarray) else out
            if any(i is not o or i.dtype != self.dtype or not i.flags.writeable for i, o in zip(images, given)):
                raise native.Error(f"out: must be C-contiguous, writeable, and {self.dtype}")
        native.call("execute", self._handle, precision_of(echoes.dtype, "echoes"), echoes.ctypes.data, pointers(images))
        return images[0] if len(images) == 1 else images


def plan(scene: Scene, spec: str, dtype=np.complex64) -> Plan:
    """Plan an image by a SPEC, "bp_sinc:taps=8"; `dtype` counts where the SPEC names no precision."""
    return Plan(scene, spec, dtype)


def image(scene: Scene, spec, echoes: Optional[np.ndarray] = None) -> Image:
    """The image [rows, columns] by a SPEC, or by an algorithm of one's own (sasbench.algorithm).

    Its dtype is that of the echoes, unless the SPEC names a precision. Without echoes it is the image of the scene's
    own, as `sasbench image` forms it: single precision unless the SPEC says double.
    """
    own = not isinstance(spec, str)
    dtype = np.asarray(echoes).dtype if echoes is not None else spec.dtype if own else np.complex64
    if own:
        given = simulate(scene, dtype) if echoes is None else checked(echoes, scene._acquisition.shape, "echoes")
        images = spec.images(scene, given)
        return images[0] if len(images) == 1 else images
    precision_of(dtype, "echoes")
    planned = Plan(scene, spec, dtype)
    return planned.execute(simulate(scene) if echoes is None else echoes)


def reference(scene: Scene, echoes: Optional[np.ndarray] = None) -> Image:
    """The exact image, complex128: every pair summed at its exact delay."""
    return image(scene, "reference:precision=double", echoes)


def algorithms() -> dict[str, dict]:
    """By name: summary, reference, and settings, by name: summary, default, and choices or min and max."""
    found: dict[str, dict] = {}
    summary, source, setting = c_char_p(), c_char_p(), native.Setting()
    while name := native.call("algorithm", len(found), byref(summary), byref(source)):
        settings: dict[str, dict] = {}
        while native.call("setting", len(found), len(settings), byref(setting)):
            about = {"summary": native.text(setting.summary)}
            if setting.names:
                choices = []
                while setting.names[len(choices)]:
                    choices.append(native.text(setting.names[len(choices)]))
                about |= {"default": choices[int(setting.initial)], "choices": choices}
            elif setting.kind == 3:
                about["default"] = native.text(setting.text)
            else:
                about |= {"default": setting.initial, "min": setting.min, "max": setting.max}
            settings[native.text(setting.name)] = about
        found[native.text(name)] = {
            "summary": native.text(summary.value), "reference": native.text(source.value), "settings": settings,
        }  # fmt: skip
    return found
