"""CARMEN logs of other recorders."""
import bz2
import gzip

from common import *  # noqa: F403
from carmen_logs import carmen, flaser
import floor


@case
def carmen_full_turn():  # 360 beams in FLASER, which has no angles
    _, _, scans = floor.drive('std')
    turns = {round(t, 3): r for t, r in scans}

    def line(i, t, b, lx, ly, a, x, y): return [flaser(turns[round(t - T0, 3)], lx, ly, a, x, y, t)]
    return carmen('carmen_full_turn', line)


@case
def carmen_270_degrees():  # 271 beams
    _, _, scans = floor.drive('std')
    turns = {round(t, 3): r for t, r in scans}

    def line(i, t, b, lx, ly, a, x, y): return [flaser(turns[round(t - T0, 3)][45:316], lx, ly, a, x, y, t)]
    return carmen('carmen_270_degrees', line)


@case
def carmen_90_degrees():  # 91 beams
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b[45:136], lx, ly, a, x, y, t)]
    return carmen('carmen_90_degrees', line)


@case
def carmen_180_beams():
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b[:180], lx, ly, a, x, y, t)]
    return carmen('carmen_180_beams', line)


@case
def carmen_corrected():  # the pose of the laser is corrected by a SLAM, the odometry is raw
    true, _, _ = floor.drive('std')
    by_time = {round(t, 3): (x, y, a) for t, x, y, a in true}

    def line(i, t, b, lx, ly, a, x, y):
        cx, cy, ca = by_time[round(t - T0, 3)]
        ranges = ' '.join('%.3f' % r for r in b)
        return ['FLASER %d %s %f %f %f %f %f %f %f robot %f' % (
            len(b), ranges, cx + 0.15 * math.cos(ca), cy + 0.15 * math.sin(ca), ca, x, y, a, t, t - T0)]
    return carmen('carmen_corrected', line)


@case
def carmen_both_corrected():  # a .gfs log: both poses are those of a SLAM
    true, _, _ = floor.drive('std')
    by_time = {round(t, 3): (x, y, a) for t, x, y, a in true}

    def line(i, t, b, lx, ly, a, x, y):
        cx, cy, ca = by_time[round(t - T0, 3)]
        return [flaser(b, cx + 0.15 * math.cos(ca), cy + 0.15 * math.sin(ca), ca, cx, cy, t)]
    return carmen('carmen_both_corrected', line)


@case
def carmen_laser_pose_only():  # odometry is 0, the pose of the laser moves
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b, lx, ly, a, 0, 0, t).replace(' %f %f %f' % (0, 0, a), ' 0 0 0')]
    return carmen('carmen_laser_pose_only', line)


@case
def carmen_odom_lines():  # the pose in FLASER is 0, ODOM lines have it
    def line(i, t, b, lx, ly, a, x, y):
        return ['ODOM %f %f %f 0.5 0.0 0.0 %f robot %f' % (x, y, a, t, t - T0), flaser(b, 0, 0, 0, 0, 0, t)]
    return carmen('carmen_odom_lines', line)


@case
def carmen_params_comments():
    header = ['# CARMEN Logfile', '# file format is one message per line', '# message_name [message contents] ipc_timestamp',
              'PARAM robot_frontlaser_offset 0.15 nohost 0', 'PARAM laser_front_laser_resolution 1.0 nohost 0',
              'SYNC NONE 0 robot 0', '']

    def line(i, t, b, lx, ly, a, x, y):
        return ['# comment', '  ' + flaser(b, lx, ly, a, x, y, t).replace(' ', '\t'), 'TRUEPOS 0 0 0 0 0 0 %f r %f' % (t, t - T0)]
    return carmen('carmen_params_comments', line, header)


@case
def carmen_bom_utf8():
    path = carmen('carmen_bom_utf8', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])
    data = open(path, 'rb').read()
    open(path, 'wb').write(b'\xef\xbb\xbf' + data)
    return path


@case
def carmen_utf16():  # a redirection of PowerShell
    path = carmen('carmen_utf16', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])
    text = open(path).read()
    open(path, 'wb').write(text.replace('\n', '\r\n').encode('utf-16'))
    return path


@case
def carmen_zeros_at_end():  # the machine lost its power
    path = carmen('carmen_zeros_at_end', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])
    with open(path, 'ab') as out:
        out.write(b'FLASER 181 1.0 2.0' + bytes(100000))
    return path


@case
def carmen_mac_line_ends():
    path = carmen('carmen_mac_line_ends', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])
    data = open(path, 'rb').read()
    open(path, 'wb').write(data.replace(b'\n', b'\r'))
    return path


@case
def carmen_bz2():
    path = carmen('carmen_bz2', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])
    with bz2.open(path + '.bz2', 'wb', 1) as out:
        out.write(open(path, 'rb').read())
    return path + '.bz2'


@case
def carmen_named_txt_gz_twice():
    path = carmen('carmen_named_txt_gz_twice', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])
    data = gzip.compress(gzip.compress(open(path, 'rb').read(), 1), 1)
    open(path + '.gz', 'wb').write(data)
    return path + '.gz'


@case
def carmen_milliseconds():  # stamps in ms
    def line(i, t, b, lx, ly, a, x, y):
        return [' '.join(flaser(b, lx, ly, a, x, y, t).split()[:-3] + ['%f robot %f' % (1000 * t, 1000 * (t - T0))])]
    return carmen('carmen_milliseconds', line)


@case
def carmen_stamps_zero():
    def line(i, t, b, lx, ly, a, x, y):
        return [' '.join(flaser(b, lx, ly, a, x, y, t).split()[:-3] + ['0 robot 0'])]
    return carmen('carmen_stamps_zero', line)


@case
def carmen_no_stamps():  # the line ends with the odometry
    def line(i, t, b, lx, ly, a, x, y):
        return [' '.join(flaser(b, lx, ly, a, x, y, t).split()[:-3])]
    return carmen('carmen_no_stamps', line)


@case
def carmen_twice_in_file():  # the log was appended to itself
    path = carmen('carmen_twice_in_file', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])
    data = open(path).read()
    open(path, 'a').write(data)
    return path


@case
def carmen_reversed_file():  # newest line first
    path = carmen('carmen_reversed_file', lambda i, t, b, lx, ly, a, x, y: [flaser(b, lx, ly, a, x, y, t)])
    lines = open(path).read().split('\n')
    open(path, 'w').write('\n'.join(lines[::-1]) + '\n')
    return path


@case
def carmen_count_wrong():  # the count says 180 while there are 181 readings
    def line(i, t, b, lx, ly, a, x, y): return [flaser(b, lx, ly, a, x, y, t).replace('FLASER 181', 'FLASER 180')]
    return carmen('carmen_count_wrong', line)


@case
def carmen_robotlaser_radians_lost():  # ROBOTLASER1 with degrees for start, field and step
    def line(i, t, b, lx, ly, a, x, y):
        ranges = ' '.join('%.3f' % r for r in b)
        return ['ROBOTLASER1 0 -90 180 1 80.0 0.01 0 %d %s 0 %f %f %f %f %f %f 0 0 0.3 0.3 1.0 %f robot %f' % (
            len(b), ranges, lx, ly, a, x, y, a, t, t - T0)]
    return carmen('carmen_robotlaser_radians_lost', line)


@case
def carmen_robotlaser_remission():
    def line(i, t, b, lx, ly, a, x, y):
        ranges = ' '.join('%.3f' % r for r in b)
        return ['ROBOTLASER1 0 %f %f %f 80.0 0.01 1 %d %s %d %s %f %f %f %f %f %f 0 0 0.3 0.3 1.0 %f robot %f' % (
            -math.pi / 2, math.pi, math.pi / 180, len(b), ranges, len(b), ' '.join(['12'] * len(b)), lx, ly, a, x, y, a, t,
            t - T0)]
    return carmen('carmen_robotlaser_remission', line)


@case
def carmen_robotlaser_step_zero():
    def line(i, t, b, lx, ly, a, x, y):
        ranges = ' '.join('%.3f' % r for r in b)
        return ['ROBOTLASER1 0 %f %f 0 80.0 0.01 0 %d %s 0 %f %f %f %f %f %f 0 0 0.3 0.3 1.0 %f robot %f' % (
            -math.pi / 2, math.pi, len(b), ranges, lx, ly, a, x, y, a, t, t - T0)]
    return carmen('carmen_robotlaser_step_zero', line)


@case
def carmen_millimetres_all():  # ranges and poses
    def line(i, t, b, lx, ly, a, x, y):
        m = 1000
        return [flaser([m * r for r in b], m * lx, m * ly, a, m * x, m * y, t)]
    return carmen('carmen_millimetres_all', line)


@case
def carmen_centimetres_all():
    def line(i, t, b, lx, ly, a, x, y):
        m = 100
        return [flaser([m * r for r in b], m * lx, m * ly, a, m * x, m * y, t)]
    return carmen('carmen_centimetres_all', line)


@case
def carmen_rear_laser():  # FLASER holds the scans of a laser that looks back; both poses are alike
    _, _, rear = floor.drive('back', mount=BACK['mount'])
    turns = {round(t, 3): r for t, r in rear}

    def line(i, t, b, lx, ly, a, x, y): return [flaser(turns[round(t - T0, 3)][90:271], x, y, a, x, y, t)]
    return carmen('carmen_rear_laser', line)


@case
def carmen_reset_and_clock():  # the robot restarts: odometry and clock begin again, appended to the same log
    _, odometry, _ = floor.drive('std')
    _, x0, y0, a0 = next(p for p in odometry if p[0] > 80)

    def line(i, t, b, lx, ly, a, x, y):
        if t - T0 > 80:
            c, s = math.cos(-a0), math.sin(-a0)
            x, y, a = c * (x - x0) - s * (y - y0), s * (x - x0) + c * (y - y0), math.remainder(a - a0, 2 * math.pi)
            lx, ly = x + 0.15 * math.cos(a), y + 0.15 * math.sin(a)
        return [flaser(b, lx, ly, a, x, y, t)]
    return carmen('carmen_reset_and_clock', line)
