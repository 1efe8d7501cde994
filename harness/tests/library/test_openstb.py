"""openSTB's results as echo files: a stand-in for openSTB, whose echoes have iterated travel times of their own."""

import enum
import os
import sys
import tempfile
import types
import unittest

try:
    import numpy as np
    import scipy.io  # noqa: F401
except ImportError as error:
    print(f"skipped: {error}; python3-numpy and python3-scipy are needed")
    sys.exit(77)

import sasbench
from sasbench import openstb

Format = enum.Enum("Format", ["ZARR_BASEBAND_PRESSURE", "OTHER"])
SPEED, FS, CARRIER, BAND, LENGTH = 1480.0, 40e3, 104e3, (100e3, 120e3), 5e-3
DEPTH, PLACES = 12.0, [(1.0, 30.0), (1.6, -31.0)]  # m; either side
PINGS = 0.1 * np.arange(24)
# Crabbing by 8 degrees about z and rolled by 10 about x: scalar first.
TURN = np.array([np.cos(0.07), 0, 0, np.sin(0.07)]), np.array([np.cos(0.0873), np.sin(0.0873), 0, 0])


def matrix(q):
    """The rotation by a quaternion, by its columns."""
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


class Trajectory:
    """A straight one that climbs, and ends before the middle of the last record."""

    duration = PINGS[-1] + 0.045

    def within(self, t, values):
        return np.where(((t >= 0) & (t <= self.duration))[..., None], values, np.nan)

    def position(self, t):
        t = np.asarray(t, dtype=float)
        return self.within(t, [-0.5, 0.1, 3.0] + t[..., None] * [1.1, 0, -0.02])

    def velocity(self, t):
        return self.within(np.asarray(t), np.full(np.shape(t) + (3,), [1.1, 0, -0.02]))

    def orientation(self, t):
        (a, _, _, d), (e, f, _, _) = TURN  # their product: the roll first
        q = np.full(np.shape(t) + (4,), [a * e, a * f, d * f, d * e])
        return types.SimpleNamespace(ndarray=self.within(np.asarray(t), q))


class Signal:
    duration, minimum_frequency, maximum_frequency = LENGTH, *BAND

    def sample(self, t, baseband_frequency):
        phase = 2 * np.pi * (BAND[0] - baseband_frequency) * t + np.pi * (BAND[1] - BAND[0]) / LENGTH * t**2
        inside = (t >= 0) & (t <= LENGTH)
        return np.where(inside, 3000 * np.sin(np.pi * np.clip(t / LENGTH, 0, 1)) ** 2 * np.exp(1j * phase), 0)


class Environment:
    def __init__(self, slope=0.0):
        self.slope = slope

    def sound_speed(self, t, position):
        return SPEED + self.slope * np.asarray(t) if self.slope else np.array([SPEED])


class Iterative:
    def times(self, config, ping, target):
        """Travel times to each receiver, which moves until they no longer change."""
        place, turn = config["trajectory"].position, matrix(TURN[0]) @ matrix(TURN[1])
        out = np.linalg.norm(place(ping) + turn @ config["transmitter"].position - target)
        found = []
        for receiver in config["receivers"]:
            tau = 2 * out / SPEED
            for _ in range(20):
                at = place(self.received(ping, tau)) + turn @ receiver.position
                tau = (out + np.linalg.norm(at - target)) / SPEED
            found.append(tau)
        return np.array(found)

    def received(self, ping, tau):
        return ping + tau


class StopAndHop(Iterative):
    def received(self, ping, tau):
        return ping


def configuration(travel_time):
    places = [np.array([0.3 + 0.04 * k, 0.2, 0.1 * (k % 2)]) for k in range(4)]
    return {
        "trajectory": Trajectory(), "environment": Environment(), "signal": Signal(), "travel_time": travel_time,
        "transmitter": types.SimpleNamespace(position=np.array([0.1, 0.25, 0.3])),
        "receivers": [types.SimpleNamespace(position=p) for p in places],
        "ping_times": types.SimpleNamespace(calculate=lambda trajectory: PINGS),
    }  # fmt: skip


def simulated(config, place):
    """What openSTB hands to its converters: [pings, channels, samples], and the travel times."""
    count, guard = 4000, 256
    t = np.arange(count + guard) / FS
    spectrum = np.fft.fft(config["signal"].sample(t, CARRIER))
    f = np.fft.fftfreq(len(t), 1 / FS) + CARRIER
    tau = np.array([config["travel_time"].times(config, p, np.array([*place, DEPTH])) for p in PINGS])
    pressure = np.fft.ifft(0.5 * spectrum * np.exp(-2j * np.pi * f * tau[..., None]))[..., :count]

    class Group(dict):
        attrs = {"baseband_frequency": CARRIER, "sample_rate": FS}

    return Group(pressure=pressure, sample_time=t[:count], ping_start_time=PINGS), tau


def vertex(values):
    """Of the parabola through three values, in steps from the middle."""
    return (values[2] - values[0]) / (2 * (2 * values[1] - values[0] - values[2]))


class OpenSTB(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "a b.mat")

    def tearDown(self):
        self.folder.cleanup()

    def test_targets_are_in_place(self):
        for travel_time in (Iterative(), StopAndHop()):
            for x, y in PLACES:
                with self.subTest(type(travel_time).__name__, y=y):
                    config, step = configuration(travel_time), 0.01
                    result, tau = simulated(config, (x, y))
                    path = os.path.join(self.folder.name, f"{type(travel_time).__name__} {y}.mat")
                    converter = openstb.EchoFile(path, DEPTH, [x - step, step, 3, y - step, step, 3])
                    self.assertTrue(converter.can_handle(Format.ZARR_BASEBAND_PRESSURE, config))
                    self.assertTrue(converter.convert(Format.ZARR_BASEBAND_PRESSURE, result, config))
                    scene = sasbench.load(path)
                    delays = scene.acquisition.delay([x, y, 0])
                    self.assertLess(np.abs(delays - tau).max(), 1e-15)
                    image = sasbench.reference(scene) / (0.5 * tau.size)
                    self.assertLess(abs(image[1, 1] - 1), 1e-8)
                    self.assertLess(abs(vertex(np.abs(image[1]))), 1e-4)
                    self.assertLess(abs(vertex(np.abs(image[:, 1]))), 1e-4)
                    sinc = sasbench.image(scene, "bp_sinc:taps=32,precision=double") / (0.5 * tau.size)
                    self.assertLess(abs(sinc[1, 1] - 1), 1e-2)

    def test_refusals(self):
        config = configuration(Iterative())
        result, _ = simulated(config, PLACES[0])
        self.assertFalse(openstb.EchoFile(self.path, DEPTH).can_handle(Format.OTHER, config))
        self.assertFalse(openstb.EchoFile(self.path, DEPTH).convert("other", result, config))
        converter = openstb.EchoFile(self.path, DEPTH)
        varied = {**config, "environment": Environment(0.1)}
        far = [0, 0.1, 3, 500, 0.1, 3]
        open(os.path.join(self.folder.name, "there.mat"), "w").close()
        for words, call in {
            "the sound speed is 1480 to 1480.23 m/s along": lambda: converter.can_handle(
                Format.ZARR_BASEBAND_PRESSURE, varied
            ),
            "must end in .mat": lambda: openstb.EchoFile("echoes.npz", DEPTH),
            "not be there yet": lambda: openstb.EchoFile(os.path.join(self.folder.name, "there.mat"), DEPTH),
            "finite number of metres": lambda: openstb.EchoFile(self.path, np.nan),
            "must have 6": lambda: openstb.EchoFile(self.path, DEPTH, [1, 2, 3]),
            "no pixel meets any record": lambda: openstb.EchoFile(self.path, DEPTH, far).convert(
                Format.ZARR_BASEBAND_PRESSURE, result, config
            ),
            "has nan": lambda: converter.convert(
                Format.ZARR_BASEBAND_PRESSURE, dict_with(result, pressure=np.nan * result["pressure"]), config
            ),
        }.items():
            with self.subTest(words), self.assertRaises(sasbench.Error) as caught:
                call()
            self.assertIn(words, str(caught.exception))
        self.assertEqual(os.listdir(self.folder.name), ["there.mat"])


def dict_with(result, **changed):
    other = type(result)(result)
    other.update(changed)
    return other


if __name__ == "__main__":
    unittest.main()
