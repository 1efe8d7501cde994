"""An algorithm in Python for sasbench: serve(plan), where plan(problem) returns execute, and execute(samples) the image.

    ./sasbench run study/quick --algorithm "external:python3 my.py"

samples is [pings, receivers, samples], complex64 or complex128; the image [pixels] is of any complex type."""
import os
import sys
import time
import numpy as np
import scipy.io


class Unsupported(Exception):
    """Raised by plan with the reason, where the algorithm cannot image the problem."""


class Problem:
    """The variables of problem.mat, an echo file without samples, as attributes: fs, fc, tx, rx, ...; and:
    pixels [3, pixels], the places of all patches, row by row; pings, receivers, count (of samples), dtype."""

    def __init__(self, folder):
        self.folder = folder
        values = scipy.io.loadmat(folder + '/problem.mat', squeeze_me=True)
        self.__dict__.update({name: value for name, value in values.items() if name[0] != '_'})
        self.samples = np.load(folder + '/samples.npy', mmap_mode='r')
        self.dtype = self.samples.dtype
        self.pings, self.receivers, self.count = self.samples.shape
        self.t0 = np.broadcast_to(self.t0, self.pings)
        self.tx, self.normal = self.tx.reshape(3, -1), self.normal.reshape(3, -1)
        self.velocity = np.broadcast_to(self.velocity.reshape(3, -1), (3, self.pings))
        self.rx = self.rx.reshape((3, self.receivers, self.pings), order='F')
        self.beam_limit = values.get('beam_limit', np.inf)
        self.grids = self.image_grid.reshape(7, -1).T
        self.pixels = np.hstack([self._places(*grid) for grid in self.grids])

    @staticmethod
    def _places(x_first, x_step, x_count, r_first, r_step, r_count, angle):
        r, x = np.meshgrid(r_first + r_step * np.arange(int(r_count)), x_first + x_step * np.arange(int(x_count)),
                           indexing='ij')
        c, s = np.cos(angle), np.sin(angle)
        return np.array([x * c + r * s, -x * s + r * c, np.zeros_like(x)]).reshape(3, -1)

    def delay(self, ping, receiver):
        """Of a record: the exact delay tau (s) of each pixel, where the record is read, q, and whether the pair counts."""
        ray = self.pixels - self.tx[:, ping, None]
        out = np.sqrt((ray ** 2).sum(0)) / self.sound_speed
        away = self.rx[:, receiver, ping, None] - self.pixels
        v = self.velocity[:, ping, None]
        # |away + v tau| = c (tau - out), solved for tau
        a = self.sound_speed ** 2 - (v ** 2).sum()
        b = self.sound_speed ** 2 * out + (away * v).sum(0)
        e = (away ** 2).sum(0) - (self.sound_speed * out) ** 2
        tau = (b + np.sqrt(b * b + a * e)) / a
        q = (tau - self.t0[ping]) * self.fs
        with np.errstate(invalid='ignore'):
            sine = np.abs((ray * self.normal[:, ping, None]).sum(0)) / (self.sound_speed * out)
        return tau, q, (q >= 0) & (q <= self.count - 1) & ~(sine > self.beam_limit)

    def compress(self, samples):
        """Raw echoes after the matched filter; compressed ones as they are. In double."""
        if self.compressed:
            return samples.astype(complex)
        pulse = np.atleast_1d(self.pulse)
        size = 1 << (self.count + len(pulse) - 2).bit_length()
        spectrum = np.conj(np.fft.fft(pulse, size)) / (np.abs(pulse) ** 2).sum()
        return np.fft.ifft(np.fft.fft(samples, size) * spectrum)[..., :self.count]


def serve(plan):
    """Answer sasbench's messages on descriptors 3 and 4 until it says quit. An exception ends the program: its last
    line becomes the row's reason."""
    hears, says = os.fdopen(3), os.fdopen(4, 'w')

    def say(*words):
        print('sasbench1', *words, file=says, flush=True)

    for line in hears:
        word, _, folder = line.rstrip('\n').partition(' ')[2].partition(' ')
        if word == 'plan':
            try:
                problem = Problem(folder)
                execute = plan(problem)
                say('ok', 'python-%d.%d.%d,numpy-%s' % (*sys.version_info[:3], np.__version__))
            except Unsupported as reason:
                say('unsupported', reason)
        elif word == 'execute':
            begin = time.perf_counter()
            image = np.asarray(execute(problem.samples))
            seconds = time.perf_counter() - begin
            np.save(problem.folder + '/image.npy', image.astype(problem.dtype).ravel())
            say('took', repr(seconds))
        elif word == 'quit':
            return
