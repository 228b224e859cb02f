"""More odd odometry, and two oddities in one recording."""
from common import *  # noqa: F403
import floor


@case
def odometry_scale_half():
    return odometry_from('odometry_scale_half', poses(lambda i, t, x, y, a: (0.5 * x, 0.5 * y, a)))


@case
def odometry_scale_1_3():
    return odometry_from('odometry_scale_1_3', poses(lambda i, t, x, y, a: (1.3 * x, 1.3 * y, a)))


def turned(scale):
    """Headings and positions of a robot whose turns are measured as `scale` of the true ones."""
    _, odometry, _ = floor.drive('std')
    made, last = [], None
    ox = oy = oa = 0.0
    for t, x, y, a in odometry:
        if last is not None:
            d = math.hypot(x - last[1], y - last[2])
            da = scale * math.remainder(a - last[3], 2 * math.pi)
            ox += d * math.cos(oa + da / 2)
            oy += d * math.sin(oa + da / 2)
            oa = math.remainder(oa + da, 2 * math.pi)
        last = (t, x, y, a)
        made.append((ox, oy, oa))
    return poses(lambda i, t, x, y, a: made[i])


@case
def odometry_turns_0_7(): return odometry_from('odometry_turns_0_7', turned(0.7))


@case
def odometry_turns_1_5(): return odometry_from('odometry_turns_1_5', turned(1.5))


@case
def odometry_turns_2(): return odometry_from('odometry_turns_2', turned(2.0))


@case
def odometry_inverse():  # the pose of odom in base_link
    def function(i, t, x, y, a):
        c, s = math.cos(a), math.sin(a)
        return -(c * x + s * y), -(-s * x + c * y), -a
    return odometry_from('odometry_inverse', poses(function))


@case
def odometry_jumps_of_a_filter():  # a SLAM or a visual odometry corrects itself each 30 s
    def function(i, t, x, y, a):
        k = int(t / 30)
        return x + 0.35 * math.sin(2.1 * k), y + 0.3 * math.cos(1.3 * k) - 0.3, a + 0.05 * math.sin(k)
    return odometry_from('odometry_jumps_of_a_filter', poses(function))


@case
def odometry_noisy():  # white noise of 3 cm and 2 degrees on each message
    rnd = random.Random(6)
    return odometry_from('odometry_noisy', poses(
        lambda i, t, x, y, a: (x + rnd.gauss(0, 0.03), y + rnd.gauss(0, 0.03), a + rnd.gauss(0, 0.035))))


@case
def odometry_steps_10cm():  # wheels with coarse ticks
    return odometry_from('odometry_steps_10cm', poses(
        lambda i, t, x, y, a: (0.1 * round(x / 0.1), 0.1 * round(y / 0.1), 0.1 * round(a / 0.1))))


def with_quaternion(name, quaternion, xy=lambda x, y: (x, y)):
    _, odometry, _ = floor.drive('std')
    messages = [m for m in plain().messages() if m[1] != '/odom']
    for t, x, y, a in odometry:
        px, py = xy(x, y)
        messages.append((int((T0 + t + 0.01) * 1e9), '/odom',
                         rg.odometry(Cdr, T0 + t, 'odom', 'base_link', px, py, quaternion(a))))
    return write(name, messages)


@case
def odometry_quaternion_w_first():
    return with_quaternion('odometry_quaternion_w_first', lambda a: (math.cos(a / 2), 0, 0, math.sin(a / 2)))


@case
def odometry_quaternion_about_y():  # a game engine: y up
    return with_quaternion('odometry_quaternion_about_y', lambda a: (0, math.sin(a / 2), 0, math.cos(a / 2)))


@case
def odometry_optical_frame():  # a camera: z ahead, x to the right, y down; x and z move
    _, odometry, _ = floor.drive('std')
    messages = [m for m in plain().messages() if m[1] != '/odom']
    for t, x, y, a in odometry:
        messages.append((int((T0 + t + 0.01) * 1e9), '/odom',
                         rg.odometry(Cdr, T0 + t, 'odom', 'base_link', -y, 0.0, (0, math.sin(-a / 2), 0, math.cos(a / 2)), z=x)))
    return write('odometry_optical_frame', messages)


@case
def odometry_ned():  # x ahead, y to the right, headings clockwise, rolled by 180 degrees
    def quaternion(a): return rg.quat(-a)
    return with_quaternion('odometry_ned', quaternion, lambda x, y: (x, -y))


@case
def odometry_covariance_nan():
    _, odometry, _ = floor.drive('std')
    messages = [m for m in plain().messages() if m[1] != '/odom']
    for t, x, y, a in odometry:
        messages.append((int((T0 + t + 0.01) * 1e9), '/odom',
                         rg.odometry(Cdr, T0 + t, 'odom', 'base_link', x, y, rg.quat(a), cov=[NAN] * 36)))
    return write('odometry_covariance_nan', messages)


@case
def odometry_delayed_messages():  # stamps are right, the messages come 3 s after the scans
    recording = plain()
    messages = [(m[0] + (3 * 10**9 if m[1] == '/odom' else 0), m[1], m[2]) for m in recording.messages()]
    return write('odometry_delayed_messages', messages)


@case
def odometry_half_second_late():  # stamped 0.5 s late by a slow board
    return plain(odom_stamp=lambda i, t: T0 + t + 0.5).db3('odometry_half_second_late')


def cut_out(start, end, restart, name, clock=0.0, kind='db3'):
    """A part of the drive is missing (somebody carried the robot); `restart`: odometry begins again at zero behind it."""
    _, odometry, scans = floor.drive('std')
    _, x0, y0, a0 = next(p for p in odometry if p[0] >= end)
    messages = []
    for t, x, y, a in odometry:
        if start < t < end:
            continue
        if t >= end and restart:
            c, s = math.cos(-a0), math.sin(-a0)
            x, y, a = c * (x - x0) - s * (y - y0), s * (x - x0) + c * (y - y0), math.remainder(a - a0, 2 * math.pi)
        if t >= end and not restart:  # the wheels did not turn meanwhile
            sx, sy, sa = next((p[1], p[2], p[3]) for p in odometry if p[0] >= start)
            c, s = math.cos(sa - a0), math.sin(sa - a0)
            x, y, a = sx + c * (x - x0) - s * (y - y0), sy + s * (x - x0) + c * (y - y0), a + sa - a0
        stamp = T0 + t + (clock if t >= end else 0)
        messages.append((int((T0 + t + 0.01) * 1e9), '/odom', rg.odometry(Cdr, stamp, 'odom', 'base_link', x, y, rg.quat(a))))
    for t, ranges in scans:
        if start < t < end:
            continue
        stamp = T0 + t + (clock if t >= end else 0)
        messages.append((int((T0 + t + 0.02) * 1e9), '/scan',
                         rg.laser_scan(Cdr, stamp, 'laser', -math.pi, math.pi, 2 * math.pi / 360, 0, 0.2, 0.05, 12.0, ranges)))
    messages.append((int(T0 * 1e9), '/tf_static', rg.tf(Cdr, [(T0, *FRONT_TF)])))
    return write(name, messages, kind=kind)


@case
def both_carried_and_restarted(): return cut_out(62.0, 90.0, True, 'both_carried_and_restarted')


@case
def both_carried_switched_on():  # carried in 0 s: the recording was paused
    return cut_out(62.0, 90.0, False, 'both_carried_switched_on', kind='mcap')


@case
def both_restart_and_clock_hour(): return cut_out(80.0, 80.2, True, 'both_restart_and_clock_hour', clock=3600.0)


@case
def both_restart_and_clock_back(): return cut_out(80.0, 80.2, True, 'both_restart_and_clock_back', clock=-4000.0)


@case
def both_carried_and_clock_back(): return cut_out(62.0, 90.0, True, 'both_carried_and_clock_back', clock=-80.0)


@case
def both_degrees_and_millimetres():
    return odometry_from('both_degrees_and_millimetres',
                         poses(lambda i, t, x, y, a: (1000 * x, 1000 * y, math.degrees(a))))


@case
def both_backwards_unknown_and_reset():
    _, odometry, _ = floor.drive('std')
    recording = plain(static=None, **BACK)
    messages = [m for m in recording.messages() if m[1] != '/odom']
    function = rebased([80.0])
    for i, (t, x, y, a) in enumerate(odometry):
        for stamp, px, py, pa in function(i, t, x, y, a):
            messages.append((int((T0 + t + 0.01) * 1e9), '/odom',
                             rg.odometry(Cdr, stamp, 'odom', 'base_link', px, py, rg.quat(pa))))
    topics = plain().topics()
    return write('both_backwards_unknown_and_reset', messages, topics)


@case
def both_backwards_unknown_narrow():
    def change(i, t, m):
        m['ranges'] = m['ranges'][120:240]
        m.update(amin=m['amin'] + 120 * m['inc'], amax=m['amin'] + 239 * m['inc'])
        return m
    return with_scans(change, static=None, **BACK).db3('both_backwards_unknown_narrow')


@case
def both_millimetres_and_clockwise():
    def change(i, t, m):
        m['ranges'] = [1000 * r for r in m['ranges']][::-1]
        m['amin'] = m['amin'] + 359 * m['inc']
        m['amax'], m['inc'], m['rmax'] = -math.pi, -m['inc'], 12000.0
        return m
    return with_scans(change).db3('both_millimetres_and_clockwise')


@case
def both_millimetres_and_top_value():
    def change(i, t, m):
        m['ranges'] = [1000 * r if r < 4 else 8191.0 for r in m['ranges']]
        m['rmax'] = 8191.0
        return m
    return with_scans(change).db3('both_millimetres_and_top_value')


@case
def both_degrees_and_clockwise():
    def change(i, t, m):
        m['ranges'] = m['ranges'][::-1]
        m.update(amin=179.0, amax=-180.0, inc=-1.0)
        return m
    return with_scans(change).mcap('both_degrees_and_clockwise')


@case
def both_mirrored_and_unknown():  # scans clockwise, angles counter-clockwise, no transform
    def change(i, t, m):
        m['ranges'] = m['ranges'][::-1]
        return m
    return with_scans(change, static=None).db3('both_mirrored_and_unknown')


@case
def both_mirrored_and_no_odometry():
    def change(i, t, m):
        m['ranges'] = m['ranges'][::-1]
        return m
    return with_scans(change, odom=False).db3('both_mirrored_and_no_odometry')


@case
def both_1hz_and_late_static(): return plain(odom_every=20, static_at=170.0, static=[BACK_TF], **BACK).db3('both_1hz_and_late_static')


@case
def both_odometry_freezes_and_scan_gap():
    held = []

    def function(i, t, x, y, a):
        if 60 < t < 70:
            held.append((x, y, a))
            return held[0]
        return x, y, a
    _, odometry, scans = floor.drive('std')
    messages = [m for m in with_scans(lambda i, t, m: [] if 60 < t < 66 else [m]).messages() if m[1] != '/odom']
    for i, (t, x, y, a) in enumerate(odometry):
        px, py, pa = function(i, t, x, y, a)
        messages.append((int((T0 + t + 0.01) * 1e9), '/odom',
                         rg.odometry(Cdr, T0 + t, 'odom', 'base_link', px, py, rg.quat(pa))))
    return write('both_odometry_freezes_and_scan_gap', messages)


@case
def short_20_scans():
    recording = plain()
    messages = [m for m in recording.messages() if m[0] < int((T0 + 4) * 1e9)]
    return write('short_20_scans', messages, recording.topics())
