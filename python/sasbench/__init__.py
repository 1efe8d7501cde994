"""sasbench: imaging algorithms for multi-receiver synthetic aperture sonar, measured on identical echoes.

    import sasbench

    scene = sasbench.scene("study/quick")
    echoes = sasbench.simulate(scene)                     # complex128 [pings, receivers, samples]
    image = sasbench.image(scene, "bp_sinc", echoes)      # complex128 [rows, columns]
    print(sasbench.score(scene, image)["error"])

Units are m, s, Hz and rad. Images of a scene with several patches are lists, an image each. Failures raise
sasbench.Error. docs/python.md has more.
"""

from .files import save
from .native import Error, Unsupported
from .operators import Operator, operator
from .own import Algorithm, algorithm
from .pictures import front, show
from .scenes import (
    Acquisition,
    Grid,
    Plan,
    Scene,
    algorithms,
    image,
    load,
    make,
    plan,
    reference,
    scene,
    simulate,
    threads,
    version,
)
from .tables import compare, run, score, sweep, targets

__version__ = version()
__all__ = [
    "Acquisition", "Algorithm", "Error", "Grid", "Operator", "Plan", "Scene", "Unsupported", "algorithm", "algorithms",
    "compare", "front", "image", "load", "make", "operator", "plan", "reference", "run", "save", "scene", "score",
    "show", "simulate", "sweep", "targets", "threads",
]  # fmt: skip
