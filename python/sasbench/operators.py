"""The simulator as a linear operator, for inversion: from a reflectivity on the pixels to echoes, and its adjoint."""

from __future__ import annotations

from typing import Union

import numpy as np

from . import native, scenes


class Operator:
    """Made by `operator`: A @ image are echoes [pings, receivers, samples], A.H @ echoes an image [rows, columns].

    Vectors, as solvers have them, become vectors: shape is (all samples, all pixels), patch after patch. Numbers are
    complex128. scipy.sparse.linalg takes it as it is (aslinearoperator).
    """

    dtype = np.dtype(np.complex128)

    def __init__(self, scene: scenes.Scene, adjoint: bool = False):
        self.scene, self._adjoint = scene, adjoint
        sides = int(np.prod(scene._acquisition.shape)), sum(g.r_count * g.x_count for g in scene.grids)
        self.shape: tuple[int, int] = sides[::-1] if adjoint else sides

    @property
    def H(self) -> Operator:
        """The adjoint: a back projection with the conjugate of the same weights."""
        return Operator(self.scene, not self._adjoint)

    def __matmul__(self, x) -> Union[np.ndarray, list[np.ndarray]]:
        if isinstance(x, np.ndarray) and x.ndim == 1:
            return self.matvec(x)
        if self._adjoint:
            given = [scenes.checked(x, self.scene._acquisition.shape, "echoes")]
        else:
            given = scenes.as_list(self.scene, x)
        result = self.matvec(np.concatenate([g.ravel() for g in given]))
        if not self._adjoint:
            return result.reshape(self.scene._acquisition.shape)
        images = [image.reshape(g.shape) for g, image in zip(self.scene.grids, self._patches(result))]
        return images[0] if len(images) == 1 else images

    def matvec(self, x) -> np.ndarray:
        """The product with a vector [n] or [n, 1], as a vector."""
        x = np.ascontiguousarray(x, dtype=self.dtype).ravel()
        if x.size != self.shape[1]:
            raise native.Error(f"operator: the vector has {x.size} numbers, must have {self.shape[1]}")
        result = np.empty(self.shape[0], self.dtype)
        echoes, image = (x, result) if self._adjoint else (result, x)
        pixels = scenes.pointers(self._patches(image))
        if self._adjoint:
            native.call("adjoint", self.scene._handle, echoes.ctypes.data, pixels)
        else:
            native.call("forward", self.scene._handle, pixels, echoes.ctypes.data)
        return result

    def rmatvec(self, y) -> np.ndarray:
        """The adjoint's product with a vector."""
        return self.H.matvec(y)

    def _patches(self, image: np.ndarray) -> list[np.ndarray]:
        """Views of a vector, one a patch."""
        return np.split(image, np.cumsum([g.r_count * g.x_count for g in self.scene.grids])[:-1])


def operator(scene: scenes.Scene) -> Operator:
    """The simulator as a linear operator A, for inversion, in double precision.

    A @ image are the echoes [pings, receivers, samples] of a point of this amplitude at each pixel, as `simulate` makes
    them: exact delays, the scene's beam, no noise. A.H @ echoes is its exact adjoint. Also of recorded echoes.
    """
    return Operator(scene)
