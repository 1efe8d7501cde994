"""Pictures by matplotlib, which is imported when the first one is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Union

import numpy as np

from . import native, scenes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RANGE_DB = 60.0  # below the peak, as the program shows
FLOOR_DB = -6000.0  # a pixel that is zero; below any double


def _axes(axes):
    if axes is not None:
        return axes
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise native.Error("pictures need matplotlib: apt install python3-matplotlib, or pip install it") from error
    return plt.subplots()[1]


def show(
    image: np.ndarray, place: Union[scenes.Grid, scenes.Scene], range_db: float = RANGE_DB, axes: "Axes" = None
) -> "Axes":
    """Draw an image [rows, columns] in dB below its peak, `range_db` of them, in the program's colours.

    place: its Grid, or the Scene that it is the only patch of. axes: matplotlib's; None: of a new figure. Returns them.
    """
    grid = place.grid if isinstance(place, scenes.Scene) else place
    image = scenes.checked(image, grid.shape, "image")
    if not np.isfinite(image).all():
        raise native.Error("image: has pixels that are not finite, which have no place in a picture")
    if not 0 < range_db < np.inf:
        raise native.Error(f"range_db is {range_db!r}, must be above 0")
    axes = _axes(axes)
    size = np.abs(image).astype(np.float64)
    peak = size.max(initial=0)
    with np.errstate(divide="ignore"):
        level = np.maximum(20 * np.log10(size / peak), FLOOR_DB) if peak > 0 else np.full(size.shape, FLOOR_DB)
    half_x, half_r = grid.x_step / 2, grid.r_step / 2
    x, r = grid.x, grid.r
    drawn = axes.imshow(
        level, cmap="viridis", vmin=-range_db, vmax=0, origin="lower", interpolation="nearest",
        extent=(x[0] - half_x, x[-1] + half_x, r[0] - half_r, r[-1] + half_r),
        aspect="equal" if 1 / 3 < (x[-1] - x[0] + 2 * half_x) / (r[-1] - r[0] + 2 * half_r) < 3 else "auto",
    )  # fmt: skip
    turned = ("turned azimuth x' (m)", "turned range r' (m)")
    x_title, r_title = turned if grid.angle != 0 else ("azimuth x (m)", "range r (m)")
    axes.set_xlabel(x_title)
    axes.set_ylabel(r_title)
    axes.figure.colorbar(drawn, ax=axes, label="dB relative to the image's peak")
    return axes


def front(rows: np.ndarray, axes: "Axes" = None) -> "Axes":
    """Draw error against run time of sasbench.run's rows, each named, and the line of those that none beats in both.

    Rows without an error or a time are left out. axes: matplotlib's; None: of a new figure. Returns them.
    """
    rows = np.atleast_1d(rows)
    kept = rows[(rows["run_s"] > 0) & (rows["error"] > 0)]
    if len(kept) == 0:
        raise native.Error("rows: none has a run time and an error; `run` measures both where `timed` is true")
    if len(set(kept["scene"])) > 1:
        raise native.Error(f"rows: are of {len(set(kept['scene']))} scenes; those of one are needed")
    axes = _axes(axes)
    kept = kept[np.lexsort((kept["error"], kept["run_s"]))]
    best = kept[kept["error"] <= np.minimum.accumulate(kept["error"])]
    axes.loglog(best["run_s"], best["error"], color="0.6", zorder=1)
    for name in dict.fromkeys(kept["algorithm"]):
        own = kept[kept["algorithm"] == name]
        axes.loglog(own["run_s"], own["error"], "o", label=name)
    axes.set_xlabel("median run time, raw echoes to image (s)")
    axes.set_ylabel("relative L2 error of the complex image")
    axes.set_title(f"{kept['scene'][0]}: error against run time")
    axes.legend()
    return axes
