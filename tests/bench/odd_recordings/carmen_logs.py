"""Odd CARMEN logs."""
import gzip

from common import *  # noqa: F403


def carmen(name, line, header=(), packed=False):
    _, odometry, scans = floor.drive('std')
    by_time = {round(t, 3): (x, y, a) for t, x, y, a in odometry}
    text = list(header)
    for i, (t, ranges) in enumerate(scans):
        x, y, a = by_time[round(t, 3)]
        # A laser that looks ahead, 180 degrees, at the centre of the robot.
        text += line(i, T0 + t, ranges[90:271], x + 0.15 * math.cos(a), y + 0.15 * math.sin(a), a, x, y)
    path = '%s/%s.clf%s' % (OUT, name, '.gz' if packed else '')
    with (gzip.open(path, 'wt') if packed else open(path, 'w')) as out:
        out.write('\n'.join(text) + '\n')
    return path


def flaser(beams, lx, ly, a, x, y, t, word='FLASER', form='%.3f'):
    ranges = ' '.join(r if isinstance(r, str) else form % r for r in beams)
    return '%s %d %s %f %f %f %f %f %f %f robot %f' % (word, len(beams), ranges, lx, ly, a, x, y, a, t, t - T0)


@case
def carmen_plain():
    return carmen('carmen_plain', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])


@case
def carmen_gz_crlf():
    return carmen('carmen_gz_crlf', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t) + '\r'], packed=True)


@case
def carmen_inf_nan():
    def line(i, t, b, lx, ly, a, x, y):
        b = ['inf' if k % 40 == 3 else '-nan' if k % 40 == 5 else r for k, r in enumerate(b)]
        return [flaser(b, lx, ly, a, x, y, t)]
    return carmen('carmen_inf_nan', line)


@case
def carmen_top_8191():
    def line(i, t, b, lx, ly, a, x, y):
        return [flaser([81.91 if r > 4 else r for r in b], lx, ly, a, x, y, t)]
    return carmen('carmen_top_8191', line)


@case
def carmen_millimetres():
    def line(i, t, b, lx, ly, a, x, y): return [flaser([1000 * r for r in b], lx, ly, a, x, y, t)]
    return carmen('carmen_millimetres', line)


@case
def carmen_centimetres():
    def line(i, t, b, lx, ly, a, x, y): return [flaser([100 * r for r in b], lx, ly, a, x, y, t)]
    return carmen('carmen_centimetres', line)


@case
def carmen_clockwise():
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b[::-1], lx, ly, a, x, y, t)]
    return carmen('carmen_clockwise', line)


@case
def carmen_degrees():
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b, lx, ly, math.degrees(a), x, y, t)]
    return carmen('carmen_degrees', line)


@case
def carmen_equal_stamps():
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b, lx, ly, a, x, y, math.floor(t))]
    return carmen('carmen_equal_stamps', line)


@case
def carmen_doubled():
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b, lx, ly, a, x, y, t)] * 2
    return carmen('carmen_doubled', line)


@case
def carmen_odometry_zero():
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b, 0, 0, 0, 0, 0, t)]
    return carmen('carmen_odometry_zero', line)


@case
def carmen_reset():
    _, odometry, _ = floor.drive('std')
    _, x0, y0, a0 = next(p for p in odometry if p[0] > 80)

    def line(i, t, b, lx, ly, a, x, y):
        if t - T0 > 80:
            c, s = math.cos(-a0), math.sin(-a0)
            x, y, a = c * (x - x0) - s * (y - y0), s * (x - x0) + c * (y - y0), math.remainder(a - a0, 2 * math.pi)
            lx, ly = x + 0.15 * math.cos(a), y + 0.15 * math.sin(a)
        return [flaser(b, lx, ly, a, x, y, t)]
    return carmen('carmen_reset', line)


@case
def carmen_outliers():
    def line(i, t, b, lx, ly, a, x, y):
        return [flaser(b, 0, 0, 0, 0, 0, t) if i % 100 == 50 else flaser(b, lx, ly, a, x, y, t)]
    return carmen('carmen_outliers', line)


@case
def carmen_robotlaser():
    def line(i, t, b, lx, ly, a, x, y):
        ranges = ' '.join('%.3f' % r for r in b)
        return ['ROBOTLASER1 0 %f %f %f 80.0 0.01 0 %d %s 0 %f %f %f %f %f %f 0 0 0.3 0.3 1.0 %f robot %f' % (
            -math.pi / 2, math.pi, math.pi / 180, len(b), ranges, lx, ly, a, x, y, a, t, t - T0)]
    return carmen('carmen_robotlaser', line)


@case
def carmen_two_lasers():
    def line(i, t, b, lx, ly, a, x, y):
        return [flaser(b, lx, ly, a, x, y, t), flaser([3.0] * 181, lx, ly, a, x, y, t + 0.01, 'RLASER')]
    return carmen('carmen_two_lasers', line)


@case
def carmen_decimal_commas():
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b, lx, ly, a, x, y, t).replace('.', ',')]
    return carmen('carmen_decimal_commas', line)
