"""Algorithms written in Python, measured beside those of the library."""

from __future__ import annotations

import ctypes
import traceback
from typing import Callable, Optional

import numpy as np

from . import native, scenes

Execute = Callable[[np.ndarray], np.ndarray]


class Algorithm:
    """Made by the decorator `algorithm`; calling it calls the function."""

    def __init__(self, function: Callable[..., Execute], dtype):
        self.function, self.dtype = function, np.dtype(dtype)
        self.name: str = function.__name__
        self.__doc__ = function.__doc__
        scenes.precision_of(dtype, "algorithm")

    def __call__(self, acquisition: scenes.Acquisition, grid: scenes.Grid) -> Execute:
        return self.function(acquisition, grid)

    def images(self, scene: scenes.Scene, echoes: np.ndarray) -> list[np.ndarray]:
        """The image [rows, columns] of each patch, in the echoes' dtype."""
        return [self._checked(self(scene.acquisition, g)(echoes), g, echoes.dtype) for g in scene.grids]

    def _checked(self, image, grid: scenes.Grid, dtype) -> np.ndarray:
        image = np.asarray(image)
        if image.shape != grid.shape:
            raise native.Error(f"{self.name}: the image's shape is {image.shape}, must be {grid.shape}")
        return image.astype(dtype, copy=False)

    def measure(self, scene: scenes.Scene, timed: bool, table) -> None:
        """Add the rows of one scene to a table."""
        call = _Call(self, scene)
        name, precision = native.encoded(self.name, "name"), scenes.precision_of(self.dtype, "algorithm")
        native.call("run", scene._handle, name, precision, ctypes.byref(call.struct), int(timed), table)
        if call.stopped is not None:
            raise call.stopped


class _Call:
    """The callbacks of one measurement. No exception may pass through C: it becomes the row's reason."""

    def __init__(self, own: Algorithm, scene: scenes.Scene):
        self.own, self.scene, self.stopped = own, scene, None
        self.execute_patches: list[Execute] = []
        self.host: Optional[native.Host] = None
        self.struct = native.Algorithm(
            native.ABI, (own.__doc__ or own.name).strip().split("\n")[0].encode(), b"Python", 0, 0, None,
            native.PLAN(self._plan), native.EXECUTE(self._execute), native.WORK(lambda plan, work: None),
            native.DESTROY(lambda plan: None),
        )  # fmt: skip

    def _guarded(self, work: Callable[[], None]) -> int:
        try:
            work()
            return native.OK
        except Exception as error:
            status = error.status if isinstance(error, native.Error) else native.FAILED
            last = traceback.extract_tb(error.__traceback__)[-1]
            place = "" if isinstance(error, native.Error) else f"{type(error).__name__} in line {last.lineno}: "
            return self.host.fail(status, b"%s", " ".join((place + str(error)).split()).encode() or b"failed")
        except BaseException as error:  # KeyboardInterrupt, SystemExit: raised again behind the measurement
            self.stopped = error
            return self.host.fail(native.FAILED, b"%s", b"interrupted")

    def _plan(self, problem, plan) -> int:
        self.host = problem.contents.host.contents
        plan[0] = 1

        def work():
            self.execute_patches = [self.own(self.scene.acquisition, g) for g in self.scene.grids]

        return self._guarded(work)

    def _execute(self, plan, samples, pixels, run) -> int:
        dtype = self.own.dtype

        def view(address, shape):
            count = int(np.prod(shape)) * dtype.itemsize
            return np.frombuffer((ctypes.c_char * count).from_address(address), dtype).reshape(shape)

        def work():
            echoes = view(samples, self.scene._acquisition.shape)
            echoes.flags.writeable = False
            for k, (execute, grid) in enumerate(zip(self.execute_patches, self.scene.grids)):
                view(pixels[k], grid.shape)[...] = self.own._checked(execute(echoes), grid, dtype)
            self.host.stage(run, b"python")

        return self._guarded(work)


def algorithm(function: Optional[Callable[..., Execute]] = None, *, dtype=np.complex64):
    """Decorate a function that takes an Acquisition and a Grid and returns `execute`, echoes to image.

    The function plans: all that depends on the geometry only, timed apart. execute takes read-only echoes
    [pings, receivers, samples] and returns the image [rows, columns]; it is timed, and given other echoes every other
    time. `dtype` is that of the echoes in `run`: complex64, as of SPECs, or complex128. Raise sasbench.Unsupported with
    the reason where the geometry cannot be imaged.
    """
    return (lambda f: Algorithm(f, dtype)) if function is None else Algorithm(function, dtype)
