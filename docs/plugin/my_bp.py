"""Back projection in numpy, each record read by a truncated sinc of `taps` samples: python3 my_bp.py [taps]"""
import sys
import numpy as np
import sasbench_external

TAPS = int(sys.argv[1]) if len(sys.argv) > 1 else 8


def plan(problem):
    near = np.arange(TAPS) - (TAPS // 2 - 1)

    def execute(samples):
        records = np.pad(problem.compress(samples), ((0, 0), (0, 0), (TAPS, TAPS)))  # zeros beyond the ends
        image = np.zeros(problem.pixels.shape[1], complex)
        for ping in range(problem.pings):
            for receiver in range(problem.receivers):
                tau, q, counts = problem.delay(ping, receiver)
                tau, q = tau[counts], q[counts]
                whole = np.floor(q).astype(int)
                read = records[ping, receiver][whole[:, None] + near + TAPS]
                value = (read * np.sinc((q - whole)[:, None] - near)).sum(1)
                image[counts] += value * np.exp(2j * np.pi * ((problem.fc * tau) % 1))
        return image

    return execute


sasbench_external.serve(plan)
