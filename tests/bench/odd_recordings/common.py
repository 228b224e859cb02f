"""What the recordings share: the drive of the cases folder, altered in one respect."""
import math
import os
import random
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
sys.path.insert(0, os.environ.get('TOPOGEO_CASES', os.path.join(os.path.dirname(ROOT), 'shared', 'cases')))
import cases  # noqa: E402
import floor  # noqa: E402
import rosgen as rg  # noqa: E402
from cases import OUT, Rec, T0, compose  # noqa: E402
from rosgen import Cdr, Ros1  # noqa: E402

NAN, INF = float('nan'), float('inf')
CASES = {}
BACK = dict(drive='back', mount=(-0.2, 0.0, math.pi, False))
BACK_TF = ('base_link', 'laser') + compose((-0.2, 0, math.pi))
FRONT_TF = ('base_link', 'laser', (0.15, 0, 0.2), (0, 0, 0, 1))


def case(function):
    CASES[function.__name__] = function
    return function


def plain(**options):
    return Rec(tf=False, **options)


def with_scans(change, **options):
    """A recording whose scans `change(number, time, fields)` alters."""
    return plain(scan_fn=change, **options)


def write(name, messages, topics=None, kind='db3'):
    messages.sort(key=lambda message: message[0])
    path = '%s/%s.%s' % (OUT, name, kind)
    topics = topics or plain().topics()
    (rg.write_db3 if kind == 'db3' else rg.write_mcap)(path, messages, topics)
    return path


def odometry_from(name, function, kind='db3'):
    """A recording with odometry (stamp, x, y, yaw) of `function(number, time, x, y, yaw)`; None: no message."""
    _, odometry, _ = floor.drive('std')
    messages = [m for m in plain().messages() if m[1] != '/odom']
    for i, (t, x, y, a) in enumerate(odometry):
        for stamp, px, py, pa in function(i, t, x, y, a) or []:
            messages.append((int((T0 + t + 0.01) * 1e9), '/odom',
                             rg.odometry(Cdr, stamp, 'odom', 'base_link', px, py, rg.quat(pa))))
    return write(name, messages, kind=kind)


def poses(function):
    """`function(number, time, x, y, yaw)` gives another pose of the same time."""
    return lambda i, t, x, y, a: [(T0 + t,) + tuple(function(i, t, x, y, a))]


def rebased(times):
    """Odometry that begins again at zero at each of these times."""
    start = [None]

    def function(i, t, x, y, a):
        if times and t >= times[0]:
            times.pop(0)
            start[0] = (x, y, a)
        if start[0] is None:
            return x, y, a
        x0, y0, a0 = start[0]
        c, s = math.cos(-a0), math.sin(-a0)
        return c * (x - x0) - s * (y - y0), s * (x - x0) + c * (y - y0), math.remainder(a - a0, 2 * math.pi)
    return poses(function)
