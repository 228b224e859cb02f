"""Odometry with one fault."""
from common import *  # noqa: F403


@case
def odometry_degrees():
    return odometry_from('odometry_degrees', poses(lambda i, t, x, y, a: (x, y, math.degrees(a))))


@case
def odometry_millimetres():
    return odometry_from('odometry_millimetres', poses(lambda i, t, x, y, a: (1000 * x, 1000 * y, a)))


@case
def odometry_left_handed():
    return odometry_from('odometry_left_handed', poses(lambda i, t, x, y, a: (x, -y, -a)))


@case
def odometry_heading_mirrored():
    return odometry_from('odometry_heading_mirrored', poses(lambda i, t, x, y, a: (x, y, -a)))


@case
def odometry_axes_swapped():
    return odometry_from('odometry_axes_swapped', poses(lambda i, t, x, y, a: (y, x, a)))


@case
def odometry_reset_twice(): return odometry_from('odometry_reset_twice', rebased([55.0, 120.0]), 'mcap')


@case
def odometry_heading_zeroed():  # the IMU restarts: heading from 0, positions go on in the new direction
    def function(i, t, x, y, a): return (x, y, math.remainder(a - 1.2, 2 * math.pi)) if t > 90 else (x, y, a)
    return odometry_from('odometry_heading_zeroed', poses(function))


@case
def odometry_outliers_heading():
    return odometry_from('odometry_outliers_heading', poses(lambda i, t, x, y, a: (x, y, 0.0 if i % 300 == 99 else a)))


@case
def odometry_outliers_at_end():
    return odometry_from('odometry_outliers_at_end',
                         poses(lambda i, t, x, y, a: (0.0, 0.0, 0.0) if i > 3510 else (x, y, a)))


@case
def odometry_outliers_burst():
    return odometry_from('odometry_outliers_burst',
                         poses(lambda i, t, x, y, a: (-50.0, 20.0, 1.0) if 60 < t < 60.3 else (x, y, a)))


@case
def odometry_outliers_random():
    rnd = random.Random(11)

    def function(i, t, x, y, a):
        if rnd.random() < 0.01:
            return x + rnd.uniform(-3, 3), y + rnd.uniform(-3, 3), a
        return x, y, a
    return odometry_from('odometry_outliers_random', poses(function))


@case
def odometry_outliers_huge():
    return odometry_from('odometry_outliers_huge',
                         poses(lambda i, t, x, y, a: (1e12, -1e9, a) if i in (700, 1500, 1501) else (x, y, a)))


@case
def odometry_nan_start():
    return odometry_from('odometry_nan_start', poses(lambda i, t, x, y, a: (NAN, NAN, NAN) if t < 3 else (x, y, a)))


@case
def odometry_infinite():
    return odometry_from('odometry_infinite', poses(lambda i, t, x, y, a: (INF, y, a) if i % 40 == 3 else (x, y, a)))


@case
def odometry_twice():
    return odometry_from('odometry_twice', lambda i, t, x, y, a: [(T0 + t, x, y, a)] * 2)


@case
def odometry_gap_driving():
    return odometry_from('odometry_gap_driving', lambda i, t, x, y, a: None if 60 < t < 66 else [(T0 + t, x, y, a)])


@case
def odometry_ends_early():
    return odometry_from('odometry_ends_early', lambda i, t, x, y, a: None if t > 100 else [(T0 + t, x, y, a)])


@case
def odometry_starts_late():
    return odometry_from('odometry_starts_late', lambda i, t, x, y, a: None if t < 60 else [(T0 + t, x, y, a)])


@case
def odometry_freezes():  # the encoders' board hangs for 10 s while the robot drives, then goes on from there
    held = []

    def function(i, t, x, y, a):
        if 60 < t < 70:
            held.append((x, y, a))
            return held[0]
        return x, y, a
    return odometry_from('odometry_freezes', poses(function))


@case
def odometry_two_publishers():  # wheels and a filter on one topic, with the same frames; the filter is turned by 0.5 rad
    def function(i, t, x, y, a):
        c, s = math.cos(0.5), math.sin(0.5)
        return [(T0 + t, x, y, a), (T0 + t + 0.02, 2 + c * x - s * y, s * x + c * y, a + 0.5)]
    return odometry_from('odometry_two_publishers', function)


@case
def odometry_backward_yaw():  # the heading is that of the rear: the robot seems to drive backwards
    return odometry_from('odometry_backward_yaw', poses(lambda i, t, x, y, a: (x, y, a + math.pi)))


@case
def odometry_far_origin():  # UTM
    return odometry_from('odometry_far_origin', poses(lambda i, t, x, y, a: (4.5e5 + x, 4.1e6 + y, a)))


@case
def odometry_yaw_only():  # an IMU without wheels
    return odometry_from('odometry_yaw_only', poses(lambda i, t, x, y, a: (0.0, 0.0, a)))


@case
def odometry_no_yaw():  # positions of a beacon system: the heading stays 0
    return odometry_from('odometry_no_yaw', poses(lambda i, t, x, y, a: (x, y, 0.0)))
