"""The Python package: its images against those of the program, its errors, algorithms of one's own."""

import concurrent.futures
import csv
import dataclasses
import gc
import importlib.util
import os
import resource
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

try:
    import numpy as np
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(77)

import matlab
import sasbench
from sasbench import native

SPECS = [
    "bp_nearest", "bp_linear", "bp_sinc:taps=8", "bp_zeropad", "bp_farrow", "bp_fitted", "bp_factorised", "rma_lbf",
    "rma_wu", "rma_delay", "monostatic | wk_squint", "reference",
]  # fmt: skip

SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../scenes")


def program(*arguments):
    return subprocess.run([os.environ["SASBENCH_PROGRAM"], *arguments], check=True, capture_output=True, text=True)


@sasbench.algorithm(dtype=np.complex128)
def nearest(a, grid):
    """bp_nearest again."""
    delays = a.delay(grid.points())
    q = np.rint((delays - a.t0[:, None, None, None]) * a.fs).astype(int)
    factors = np.exp(2j * np.pi * a.fc * delays) * ((q >= 0) & (q < a.samples))
    ping, receiver = np.ogrid[: a.shape[0], : a.shape[1]]
    places = ping[..., None, None], receiver[..., None, None], q.clip(0, a.samples - 1)
    return lambda echoes: (a.compress(echoes)[places] * factors).sum((0, 1))


class Python(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.scene = sasbench.scene("study/quick")
        cls.echoes = sasbench.simulate(cls.scene)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def of_program(self, k, spec, *source):
        path = self.path(f"{k}.mat")
        program("image", *source, "-a", spec, "-o", path)
        return matlab.variables(path)["image"]

    def assert_same(self, image, other):
        self.assertEqual(image.dtype, other.dtype)
        self.assertEqual(image.tobytes(), np.ascontiguousarray(other).tobytes())

    def test_images_are_the_programs(self):
        """To the bit, in both precisions, formed in two threads at once."""
        asked = [f"{s}{',' if ':' in s else ':'}precision={p}" for s in SPECS for p in ("float", "double")]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            images = list(pool.map(lambda spec: sasbench.image(self.scene, spec), asked))
        for k, (spec, image) in enumerate(zip(asked, images)):
            with self.subTest(spec):
                self.assert_same(image, self.of_program(k, spec, "--scene", "study/quick"))

    def test_dtype_follows_the_echoes(self):
        single = sasbench.image(self.scene, "bp_sinc", self.echoes.astype(np.complex64))
        self.assert_same(single, sasbench.image(self.scene, "bp_sinc"))
        self.assertEqual(sasbench.image(self.scene, "bp_sinc", self.echoes).dtype, np.complex128)
        self.assertEqual(sasbench.image(self.scene, "bp_sinc:precision=float", self.echoes).dtype, np.complex64)

    def test_files_are_the_programs(self):
        path = self.path("echoes.mat")
        program("simulate", "study/quick", "-o", path)
        samples = matlab.variables(path)["samples"]
        kinds = [getattr(resource, name) for name in dir(resource) if name.startswith("RLIMIT_")]
        limits = [resource.getrlimit(kind) for kind in kinds]
        self.assert_same(self.echoes, np.transpose(samples, (2, 1, 0)))
        read = sasbench.load(path)
        self.assert_same(sasbench.simulate(read), self.echoes)
        self.assertEqual(limits, [resource.getrlimit(kind) for kind in kinds])  # reading leaves the process as it was
        image = self.of_program("file", "bp_sinc:precision=double", "--echoes", path)
        self.assert_same(sasbench.image(read, "bp_sinc:precision=double"), image)
        part = sasbench.Grid(-0.1, 0.05, 5, 19.9, 0.05, 4)
        self.assertEqual(sasbench.image(sasbench.load(path, part), "bp_sinc").shape, (4, 5))

    def test_scores_are_the_programs(self):
        program("image", "--scene", "study/quick", "-a", "bp_linear", "-o", self.path("i.mat"))
        program("score", self.path("i.mat"), "study/quick", "-o", self.path("scores"), "--name", "mine")
        with open(self.path("scores/measurements.csv")) as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        row = sasbench.score(self.scene, sasbench.image(self.scene, "bp_linear"), "mine")
        self.assertEqual(list(row.dtype.names), list(rows[0]))
        for name in ("error", "error_gain", "phase_rms_rad", "width_m", "pslr_db", "islr_db", "entropy"):
            self.assertAlmostEqual(row[name] / float(rows[0][name]), 1, delta=1e-6, msg=name)
        self.assertEqual(row["algorithm"], "mine")

    def test_scenes_of_arrays(self):
        made = sasbench.make(self.scene.acquisition, self.scene.grid, self.echoes, self.scene.points, "made")
        self.assert_same(sasbench.image(made, "bp_sinc"), sasbench.image(self.scene, "bp_sinc"))
        self.assertLess(sasbench.score(made, sasbench.reference(made))["error"], 1e-15)
        points = np.array([[0, 20, 1, 0], [0.1, 20.1, 0, 2.0]])
        both, first, second = (
            sasbench.simulate(sasbench.make(self.scene.acquisition, self.scene.grid, points=p))
            for p in (points, points[0], points[1])
        )
        self.assertLess(np.abs(both - first - second).max(), 1e-12 * np.abs(both).max())

    @unittest.skipIf(importlib.util.find_spec("scipy") is None, "python3-scipy is not installed")
    def test_saved_files(self):
        """They hold the arrays, to the bit, in both precisions; what fails leaves nothing."""
        a, grid, points = self.scene.acquisition, self.scene.grid, np.array([[0, 20, 1, 0.5], [0.1, 20.1, 0, -2.0]])
        grids = [grid, sasbench.Grid(0.1, 0.01, 3, 20, 0.02, 2, 0.25)]
        path = self.path("a 'b.mat")
        for echoes in (self.echoes, self.echoes.astype(np.complex64)):
            sasbench.save(path, a, echoes, grids, points)
            read, made = sasbench.load(path), sasbench.make(a, grids, echoes, points)
            self.assertEqual(matlab.variables(path)["samples"].dtype, echoes.dtype)
            self.assert_same(sasbench.simulate(read, echoes.dtype), echoes)
            self.assertEqual(read.grids, made.grids)
            self.assertEqual(read.points.tobytes(), points.tobytes())
            for field in ("t0", "tx", "rx", "velocity", "pulse"):
                self.assertEqual(getattr(read.acquisition, field).tobytes(), getattr(made.acquisition, field).tobytes())
            for field in ("samples", "sound_speed", "fc", "fs", "bandwidth", "tx_length", "rx_length"):
                self.assertEqual(getattr(read.acquisition, field), getattr(made.acquisition, field))
            for spec in ("bp_sinc", "rma_lbf"):  # range migration takes the beam from the element lengths
                same = [sasbench.run(s, spec, timed=False)["error"] for s in (read, made)]
                self.assertEqual(same[0].tobytes(), same[1].tobytes())
        compressed = dataclasses.replace(a, pulse=None, aperture_limit=0.5)
        sasbench.save(path, compressed, self.echoes)
        self.assertIsNone(sasbench.load(path, grid).acquisition.pulse)
        self.assertEqual(sasbench.load(path, grid).acquisition.aperture_limit, 0.5)
        sasbench.save(path, dataclasses.replace(a, aperture_limit=2), self.echoes, grid)
        self.assertEqual(sasbench.load(path).acquisition.aperture_limit, np.inf)
        before = os.listdir(self.folder.name)
        with open(path, "rb") as file:
            whole = file.read()
        nan = np.full_like(self.echoes, np.nan)
        for words, call in {
            "sample 0 of receiver 0 in ping 0 has nan": lambda: sasbench.save(path, a, nan, grid),
            "must be (18, 8, 256)": lambda: sasbench.save(path, a, self.echoes[1:], grid),
            "echoes: object is no dtype": lambda: sasbench.save(path, a, None, grid),
            "tx: the shape is": lambda: sasbench.save(path, dataclasses.replace(a, tx=a.tx[:, :2]), self.echoes),
            "t0: the shape is": lambda: sasbench.save(path, dataclasses.replace(a, t0=0.02), self.echoes),
            "aperture limit is -1": lambda: sasbench.save(path, dataclasses.replace(a, aperture_limit=-1), self.echoes),
            "must end in .mat": lambda: sasbench.save(self.path("a.npy"), a, self.echoes),
            "no/a.mat: cannot be written: No such": lambda: sasbench.save(self.path("no/a.mat"), a, self.echoes),
            "no pixel meets any record": lambda: sasbench.save(path, a, self.echoes, sasbench.Grid(0, 1, 2, 99, 1, 2)),
            "has a zero in it": lambda: sasbench.save("a\0.mat", a, self.echoes),
        }.items():
            with self.subTest(words), self.assertRaises(sasbench.Error) as caught:
                call()
            self.assertIn(words, str(caught.exception))
        with open(path, "rb") as file:
            self.assertEqual(file.read(), whole)
        self.assertEqual(os.listdir(self.folder.name), before)

    @unittest.skipIf(importlib.util.find_spec("matplotlib") is None, "python3-matplotlib is not installed")
    def test_pictures(self):
        import matplotlib

        matplotlib.use("Agg")
        image = sasbench.image(self.scene, "bp_sinc")
        axes = sasbench.show(image, self.scene)
        (drawn,) = axes.get_images()
        self.assertEqual(drawn.get_clim(), (-60, 0))
        self.assertEqual(np.argmax(drawn.get_array()), np.argmax(np.abs(image)))
        self.assertAlmostEqual(drawn.get_array()[0, 0], 20 * np.log10(abs(image[0, 0]) / np.abs(image).max()), places=4)
        grid = self.scene.grid
        left, right, low, high = drawn.get_extent()
        self.assertAlmostEqual(left + grid.x_step / 2, grid.x[0])
        self.assertAlmostEqual(right - left, grid.x_count * grid.x_step)
        self.assertAlmostEqual(high - low, grid.r_count * grid.r_step)
        self.assertLess(sasbench.show(0 * image, grid).get_images()[0].get_array().max(), -60)
        sasbench.show(np.array([[1e-300j]]), sasbench.Grid(-0.0, 0.1, 1, 20, 0.1, 1, 0.5)).figure.canvas.draw()
        for call in (
            lambda: sasbench.show(image * np.nan, grid),
            lambda: sasbench.show(image[1:], grid),
            lambda: sasbench.show(image, grid, range_db=0),
        ):
            self.assertRaises(sasbench.Error, call)
        rows = sasbench.run(self.scene, ["bp_nearest", "bp_sinc", "bp_sinc:taps=2"])
        rows["run_s"], rows["error"] = [1, 2, 3], [0.2, 0.1, 0.15]
        line, *points = sasbench.front(rows).get_lines()
        self.assertEqual(list(line.get_xdata()), [1, 2])
        self.assertEqual([len(p.get_xdata()) for p in points], [1, 2])
        rows["run_s"] = np.nan
        self.assertRaises(sasbench.Error, lambda: sasbench.front(rows))
        matplotlib.pyplot.close("all")

    def test_extreme_numbers(self):
        """As double they are the program's; single precision that would lose digits is refused."""
        a, grid = self.scene.acquisition, self.scene.grid
        for amplitude in (1e-300, 1e-38, 1e39, 1e300):
            made = sasbench.make(a, grid, points=[0, 20, amplitude, 0])
            image = sasbench.image(made, "bp_sinc:precision=double")
            self.assertAlmostEqual(np.abs(image).max() / amplitude, 142, delta=3)
            for call in (lambda: sasbench.image(made, "bp_sinc"), lambda: sasbench.simulate(made, np.complex64)):
                with self.subTest(amplitude), self.assertRaisesRegex(sasbench.Error, "beyond single precision; double"):
                    call()
            self.assertEqual(sasbench.run(made, "bp_sinc", timed=False)["status"][0], "ok")

    def varied(self, keys):
        """study/quick with other keys."""
        path = self.path("varied.cfg")
        with open(path, "w") as file:
            file.write('base = {\n@include "%s"\n};\n%s\n' % (os.path.join(SCENES, "study/quick.cfg"), keys))
        return sasbench.scene(path)

    def test_operators_are_the_simulator(self):
        """One pixel is the target; the adjoint to a part in 1e12 of the dot product's bound."""
        random = np.random.default_rng(1)
        crooked = """track = { speed = 2.5; pri = 0.064; pings = 18; x_first = -1.52;
            errors = ( { axis = "sway"; amplitude = 0.02; period = 0.8; phase = 30.0; },
                       { axis = "yaw"; amplitude = 2.0; period = 0.5; phase = 0.0; } ); };"""
        for keys in (
            "",
            crooked + 'beam = { kind = "txrx"; truncation = "none"; per_frequency = true; };',
            crooked + 'pulse = { kind = "lfm_time"; duration = 2e-3; }; noise = { std = 0.1; };',
            'pulse = { kind = "flat"; };',
        ):
            with self.subTest(keys):
                scene = self.varied(keys + """image = { x = { first = -0.1; step = 0.05; count = 5; };
                                                          r = { first = 19.9; step = 0.05; count = 4; }; };""")
                self.assertGreater(np.abs(scene.acquisition.velocity).min(axis=0)[0], 1)
                A = sasbench.operator(scene)
                x, y = (random.standard_normal((n, 2)) @ (1, 1j) for n in A.shape[::-1])
                forward, back = A @ x, A.H @ y
                bound = np.linalg.norm(forward) * np.linalg.norm(y)
                self.assertLess(abs(np.vdot(y, forward) - np.vdot(back, x)), 1e-12 * bound)
                self.assertGreater(np.linalg.norm(back), 0)
                if "noise" not in keys:
                    image = np.zeros(scene.grid.shape, complex)
                    image[2, 2] = 1
                    echoes = sasbench.simulate(scene)
                    self.assertLess(np.abs(A @ image - echoes).max(), 1e-12 * np.abs(echoes).max())
                self.assert_same(A.H @ y.reshape(scene.acquisition.shape), back.reshape(scene.grid.shape))
        grids = [sasbench.Grid(-0.1, 0.05, 4, 19.9, 0.1, 3, 0.3), sasbench.Grid(0.2, 0.1, 1, 20, 0.1, 2)]
        images = [random.standard_normal((*g.shape, 2)) @ (1, 1j) for g in grids]
        points = np.array([(*p[:2], v.real, v.imag) for g, i in zip(grids, images)
                           for p, v in zip(g.points().reshape(-1, 3), i.ravel())])  # fmt: skip
        a = self.scene.acquisition
        A = sasbench.operator(sasbench.make(a, grids))
        echoes = sasbench.simulate(sasbench.make(a, grids, points=points))
        # numpy turns the grid to other last digits: 4e-15 m of 20, a part in 1e12 of a wavelength.
        self.assertLess(np.abs(A @ images - echoes).max(), 1e-11 * np.abs(echoes).max())
        self.assertEqual([i.shape for i in A.H @ echoes.astype(np.complex64)], [(3, 4), (2, 1)])
        recorded = sasbench.operator(sasbench.make(a, grids, echoes))
        self.assert_same(recorded @ images, A @ images)
        vector = np.concatenate([i.ravel() for i in images])
        if importlib.util.find_spec("scipy"):
            from scipy.sparse.linalg import lsqr

            self.assertLess(np.abs(lsqr(A, echoes.ravel(), atol=1e-9, btol=1e-9)[0] - vector).max(), 1e-3)
        for words, call in {
            "has 13 numbers, must have 14": lambda: A @ vector[1:],
            "has 1 patches, must have 2": lambda: A @ images[0],
            "pixel 13 of the reflectivity is not finite": lambda: A @ np.append(vector[:-1], np.nan),
            "sample 0 of receiver 0 in ping 0 has inf": lambda: A.H @ np.full(echoes.shape, np.inf + 0j),
            "too extreme": lambda: A.H @ np.full(echoes.shape, 1e308 + 0j),
        }.items():
            with self.subTest(words), np.errstate(all="ignore"), self.assertRaisesRegex(sasbench.Error, words):
                call()
        self.assertLess(np.abs(A @ (1e-300 * vector) / 1e-300 - (A @ vector).ravel()).max(), 1e-12)

    def test_delays(self):
        a, point = self.scene.acquisition, np.array([0.3, 20.0, -1.0])
        delays = a.delay(point)
        back = a.rx + a.velocity[:, None] * delays[..., None]
        way = np.linalg.norm(a.tx - point, axis=-1)[:, None] + np.linalg.norm(back - point, axis=-1)
        self.assertLess(np.abs(delays - way / a.sound_speed).max(), 1e-15)

    def test_plans_are_used_again(self):
        plan = sasbench.plan(self.scene, "rma_lbf", np.complex128)
        out = np.empty(self.scene.grid.shape, np.complex128)
        self.assertIs(plan.execute(self.echoes, out), out)
        twice = plan.execute(2 * self.echoes)
        self.assert_same(twice, 2 * out)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for image in pool.map(lambda _: plan.execute(self.echoes), range(4)):
                self.assert_same(image, out)
        with self.assertRaisesRegex(sasbench.Error, "^out: must be C-contiguous, writeable, and complex128$"):
            plan.execute(self.echoes, out[:, ::-1])

    def test_plans_end_before_their_scenes(self):
        """Also where Python finds both at once, in a circle."""
        ended, call = [], native.call
        with unittest.mock.patch.object(native, "call", lambda name, *a: (ended.append(name), call(name, *a))[1]):
            for circle in range(2):
                scene = sasbench.scene("study/quick")
                plan = sasbench.plan(scene, "bp_sinc")
                plan.circle, scene.circle = (plan, None) if circle == 0 else (None, plan)
                del scene, plan
                gc.collect()
        self.assertEqual([name for name in ended if name.endswith("_free")], 2 * ["plan_free", "scene_free"])

    def test_own_algorithms_are_measured(self):
        @sasbench.algorithm
        def refuses(a, grid):
            raise sasbench.Unsupported("too many pings")

        @sasbench.algorithm
        def fails(a, grid):
            return lambda echoes: echoes[1000]

        @sasbench.algorithm
        def misshapes(a, grid):
            return lambda echoes: echoes

        @sasbench.algorithm
        def nests(a, grid):
            sasbench.run(self.scene, "bp_sinc", timed=False)

        @sasbench.algorithm
        def calls(a, grid):
            """Another scene and its plan, and delays in threads."""
            plan = sasbench.plan(sasbench.scene("study/quick"), "bp_sinc")
            with concurrent.futures.ThreadPoolExecutor(2) as pool:
                list(pool.map(a.delay, [grid.points()] * 4))
            return lambda echoes: plan.execute(echoes)

        called = sasbench.run(self.scene, ["bp_sinc", calls], timed=False)
        self.assertEqual(called["error"][0], called["error"][1])
        rows = sasbench.run(self.scene, ["bp_sinc", nearest, refuses, fails, misshapes, nests], timed=False)
        self.assertEqual(list(rows["status"]), ["ok", "ok", "unsupported", "failed", "failed", "failed"])
        self.assertEqual(rows["reason"][2], "refuses: too many pings")
        self.assertIn("fails: IndexError in line ", rows["reason"][3])
        self.assertIn("shape is (18, 8, 256), must be (13, 61)", rows["reason"][4])
        self.assertIn("cannot measure", rows["reason"][5])
        self.assertEqual(set(rows.targets["algorithm"]), {"bp_sinc", "nearest"})
        timed = sasbench.run(self.scene, nearest)
        self.assertGreater(timed["run_s"][0], 0)
        image = sasbench.image(self.scene, nearest, self.echoes)
        self.assertAlmostEqual(sasbench.score(self.scene, image)["error"], rows["error"][1], delta=1e-12)
        same = sasbench.image(self.scene, "bp_nearest", self.echoes)
        self.assertLess(np.abs(image - same).max(), 1e-10 * np.abs(same).max())

        @sasbench.algorithm
        def interrupted(a, grid):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            sasbench.run(self.scene, interrupted, timed=False)

    def test_sweeps_and_comparisons_are_the_programs(self):
        folder = self.path("sweep")
        program("sweep", "study/quick", "-a", "bp_sinc:taps=8", "--precision", "float", "-o", folder)
        rows = sasbench.sweep("study/quick", "bp_sinc:taps=8", "float", timed=False)
        self.assertEqual(list(rows["options"]), ["", "taps=8,window=none", "taps=8,window=kaiser"])
        for found in (
            sasbench.compare(folder, rows),
            sasbench.compare(rows.targets, os.path.join(folder, "targets.csv")),
        ):
            self.assertEqual(set(found["verdict"]), {"same"})
            self.assertEqual(set(found["scene"]), {"study/quick"})
        other = rows.copy()
        other["error"][1] *= 2
        found = sasbench.compare(rows, other)
        self.assertEqual(
            [(f["verdict"], f["metric"], f["spec"]) for f in found if f["verdict"] != "same"],
            [("worse", "error", "bp_sinc:taps=8,window=none")],
        )
        self.assertEqual(set(sasbench.compare(rows, rows[1])["verdict"]), {"gone", "same"})
        self.assertGreater(sasbench.sweep(self.scene, [], "float")["run_s"][0], 0)
        for words, call in {
            "precision is 'half'": lambda: sasbench.sweep(self.scene, "bp_sinc", "half"),
            "two of the same kind": lambda: sasbench.compare(rows, rows.targets),
            "has no columns": lambda: sasbench.compare(rows["error"], rows),
            "stands in line 3 already": lambda: sasbench.compare(rows, rows[[0, 0]]),
        }.items():
            with self.subTest(words), self.assertRaisesRegex(sasbench.Error, words):
                call()

    def test_errors(self):
        nan = self.echoes.copy()
        nan[1, 2, 3] = np.nan
        a, grid = self.scene.acquisition, self.scene.grid
        for words, call in {
            "there is no such scene; did you mean 'study/quick'?": lambda: sasbench.scene("study/quik"),
            "unknown algorithm 'bp_sink'; did you mean 'bp_sinc'?": lambda: sasbench.image(self.scene, "bp_sink"),
            "taps is '1'; accepted: ": lambda: sasbench.plan(self.scene, "bp_sinc:taps=1"),
            "accepted": lambda: sasbench.image(self.scene, "bp_sinc\0x"),
            "one_receiver": lambda: sasbench.image(self.scene, "wk_polar"),
            "sample 3 of receiver 2 in ping 1 has nan": lambda: sasbench.image(self.scene, "bp_sinc", nan),
            "must be (18, 8, 256)": lambda: sasbench.image(self.scene, "bp_sinc", self.echoes[:-1]),
            "complex64 and complex128 are accepted": lambda: sasbench.image(self.scene, "bp_sinc", self.echoes.real),
            "must be (13, 61)": lambda: sasbench.score(self.scene, self.echoes[0]),
            "not finite": lambda: sasbench.score(self.scene, np.full(grid.shape, np.inf + 0j)),
            "an algorithm of this library": lambda: sasbench.score(self.scene, self.echoes[:13, 0, :61], "bp_sinc"),
            "no.mat: cannot be read": lambda: sasbench.load(self.path("no.mat")),
            "must be 0 to 1024": lambda: sasbench.threads(-1),
            "must end in 3": lambda: a.delay([1.0, 2.0]),
            "finite numbers are needed": lambda: a.delay([np.inf, 0, 0]),
            "neither echoes nor points": lambda: sasbench.image(sasbench.make(a, grid), "bp_sinc"),
            "/a?b.cfg: ": lambda: sasbench.scene("a\nb"),
            "must be [n, 4]": lambda: sasbench.make(a, grid, points=[1.0, 2.0]),
            "at least 1 and 0": lambda: sasbench.make(a, []),
            "tx: the shape is": lambda: sasbench.make(sasbench.Acquisition(
                a.samples, a.sound_speed, a.fc, a.fs, a.bandwidth, a.t0, a.tx[:, :2], a.rx, a.velocity), grid),
        }.items():  # fmt: skip
            with self.subTest(words), self.assertRaises(sasbench.Error) as caught:
                call()
            if words != "accepted":
                self.assertIn(words, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))

    def test_damaged_files_are_refused(self):
        program("simulate", "study/quick", "-o", self.path("whole.mat"))
        with open(self.path("whole.mat"), "rb") as file:
            whole = file.read()
        for length in (0, 100, 200, len(whole) // 2, len(whole) - 1):
            with open(self.path("cut.mat"), "wb") as file:
                file.write(whole[:length])
            with self.assertRaisesRegex(sasbench.Error, "cut.mat: "):
                sasbench.load(self.path("cut.mat"))

    def test_files_are_read_anew(self):
        """A file of version 7.3 that took another's place: nothing of that one is kept, nor stays open."""
        seeds = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../fuzz/seeds/mat73")
        grid = sasbench.Grid(0, 0.1, 3, 20, 0.1, 2)
        handles = set()
        for name, words in (("raw", "meets any record"), ("szip", "packed otherwise"), ("external", "in another file")):
            with open(os.path.join(seeds, name), "rb") as seed, open(self.path("seed.mat"), "wb") as file:
                file.write(seed.read()[:-1])  # the last byte selects the fuzzer's reader
            with self.subTest(name), self.assertRaisesRegex(sasbench.Error, words):
                sasbench.load(self.path("seed.mat"), grid)
            handles.add(len(os.listdir("/proc/self/fd")))
        self.assertEqual(len(handles), 1)

    def test_interrupt_ends_images(self):
        """Of the main thread and of another one; the next image is whole again."""
        code = """if True:
            import os, signal, threading, numpy, sasbench
            quick = sasbench.scene("study/quick")
            echoes = sasbench.simulate(quick)
            before = sasbench.image(quick, "bp_sinc", echoes)
            large = sasbench.make(quick.acquisition, sasbench.Grid(-2, 0.001, 4000, 18, 0.001, 6000))
            plans = [sasbench.plan(large, "reference") for k in range(2)]
            images = [numpy.zeros((6000, 4000), numpy.complex64) + 1 for k in range(2)]  # memory takes its time
            def form():
                try:
                    plans[1].execute(echoes, images[1])
                    print("formed")
                except sasbench.Error as error:
                    print(error)
            other = threading.Thread(target=form)
            timer = threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT))
            other.start()
            timer.start()
            try:
                plans[0].execute(echoes, images[0])
                print("formed")
            except KeyboardInterrupt:
                other.join()
                print("KeyboardInterrupt")
            print((sasbench.image(quick, "bp_sinc", echoes) == before).all())
            """
        child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
        self.assertEqual((child.stdout, child.returncode), ("interrupted\nKeyboardInterrupt\nTrue\n", 0), child.stderr)

    def test_algorithms_are_listed(self):
        known = sasbench.algorithms()
        self.assertEqual(known["bp_sinc"]["settings"]["taps"]["min"], 2)
        self.assertIn("reference", known)


if __name__ == "__main__":
    unittest.main()
