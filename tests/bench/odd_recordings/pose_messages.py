"""Odometry by other messages, or by none."""
from common import *  # noqa: F403
import floor


def pose_message(E, t, frame, x, y, a, covariance=False):
    e = E()
    e.header(rg.stamp(t), frame)
    e.num('d', x, y, 0, *rg.quat(a))
    if covariance:
        e.num('d', *([0.0] * 36))
    return e.done()


def posed(name, type_, make, every=1, values=None, frame='odom', kind='db3', **options):
    """A recording with poses of another type in place of odometry; `values`: x, y, yaw of each time."""
    _, odometry, _ = floor.drive(options.get('drive', 'std'))
    recording = plain(odom=False, **options)
    messages = recording.messages()
    for t, x, y, a in (values or odometry)[::every]:
        messages.append((int((T0 + t + 0.01) * 1e9), '/pose', make(Cdr, T0 + t, frame, x, y, a)))
    topics = recording.topics()
    topics['/pose'] = type_
    return write(name, messages, topics, kind)


@case
def poses_stamped(): return posed('poses_stamped', 'geometry_msgs/msg/PoseStamped', pose_message)


@case
def poses_with_covariance():
    return posed('poses_with_covariance', 'geometry_msgs/msg/PoseWithCovarianceStamped',
                 lambda *a: pose_message(*a, covariance=True))


@case
def poses_amcl_rare():  # a localization's pose each 2 s
    return posed('poses_amcl_rare', 'geometry_msgs/msg/PoseWithCovarianceStamped',
                 lambda *a: pose_message(*a, covariance=True), every=40, frame='map')


@case
def poses_transform_stamped():
    return posed('poses_transform_stamped', 'geometry_msgs/msg/TransformStamped',
                 lambda E, t, frame, x, y, a: rg.tf(E, [(t, frame, 'base_link', (x, y, 0), rg.quat(a))])[:4]
                 + rg.tf(E, [(t, frame, 'base_link', (x, y, 0), rg.quat(a))])[8:])


@case
def poses_of_a_goal():  # the only poses are goals that a person clicked
    goals = [(20.0, 3.0, 1.0, 0.0), (80.0, 9.0, 2.0, 1.0), (140.0, 1.0, 0.0, 3.0)]
    return posed('poses_of_a_goal', 'geometry_msgs/msg/PoseStamped', pose_message, values=goals, frame='map')


@case
def poses_none(): return plain(odom=False).db3('poses_none')


@case
def poses_none_backwards(): return plain(odom=False, static=None, **BACK).bag('poses_none_backwards')


@case
def poses_none_2hz(): return plain(odom=False, scans_every=3).mcap('poses_none_2hz')


@case
def poses_none_range_4m():
    def change(i, t, m):
        m['ranges'] = [INF if r > 4 else r for r in m['ranges']]
        m['rmax'] = 4.0
        return m
    return with_scans(change, odom=False).db3('poses_none_range_4m')


@case
def poses_none_upside_down():
    return plain(odom=False, drive='flip', mount=(0.15, 0.05, 0.0, True),
                 static=[('base_link', 'laser') + compose((0.15, 0.05, 0.0), roll=math.pi)]).db3('poses_none_upside_down')


@case
def poses_none_gap():  # the recorder paused while the robot drove on
    def change(i, t, m): return [] if 60 < t < 66 else [m]
    return with_scans(change, odom=False).db3('poses_none_gap')


@case
def poses_twist_only():  # Odometry with speeds and without poses
    true, odometry, _ = floor.drive('std')
    messages = [m for m in plain().messages() if m[1] != '/odom']
    last = odometry[0]
    for t, x, y, a in odometry[1:]:
        dt = t - last[0]
        v, w = math.hypot(x - last[1], y - last[2]) / dt, math.remainder(a - last[3], 2 * math.pi) / dt
        messages.append((int((T0 + t + 0.01) * 1e9), '/odom',
                         rg.odometry(Cdr, T0 + t, 'odom', 'base_link', 0, 0, rg.quat(0), twist=(v, 0, 0, 0, 0, w))))
        last = (t, x, y, a)
    return write('poses_twist_only', messages)


@case
def poses_imu_only():
    _, odometry, _ = floor.drive('std')
    recording = plain(odom=False)
    messages = recording.messages()
    for t, _, _, a in odometry:
        e = Cdr()
        e.header(rg.stamp(T0 + t), 'imu')
        e.num('d', *rg.quat(a))
        e.num('d', *([0.0] * (9 + 3 + 9 + 3 + 9)))
        messages.append((int((T0 + t) * 1e9), '/imu', e.done()))
    topics = recording.topics()
    topics['/imu'] = 'sensor_msgs/msg/Imu'
    return write('poses_imu_only', messages, topics)
