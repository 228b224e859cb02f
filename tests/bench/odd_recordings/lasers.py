"""Odd lasers, and robots that share a recording."""
from common import *  # noqa: F403


@case
def laser_scans_twice():
    def change(i, t, m): return [m, dict(m)]
    return with_scans(change).db3('laser_scans_twice')


@case
def laser_centimetres():
    def change(i, t, m):
        m['ranges'] = [100 * r for r in m['ranges']]
        m['rmax'], m['rmin'] = 1200.0, 5.0
        return m
    return with_scans(change).db3('laser_centimetres')


@case
def laser_nan_beyond_4m():
    def change(i, t, m):
        m['ranges'] = [NAN if r > 4 else r for r in m['ranges']]
        m['rmax'] = 4.0
        return m
    return with_scans(change).db3('laser_nan_beyond_4m')


@case
def laser_top_value():  # 4.095 m for no echo, stated maximum 12 m
    def change(i, t, m):
        m['ranges'] = [4.095 if r > 4 else r for r in m['ranges']]
        return m
    return with_scans(change).mcap('laser_top_value')


@case
def laser_huge_for_nothing():
    def change(i, t, m):
        m['ranges'] = [65535.0 if r > 5 else r for r in m['ranges']]
        m['rmax'] = 65535.0
        return m
    return with_scans(change).db3('laser_huge_for_nothing')


@case
def laser_blank_scans():
    rnd = random.Random(5)

    def change(i, t, m):
        if rnd.random() < 0.3:
            m['ranges'] = [] if i % 2 else [NAN] * 360
        return m
    return with_scans(change).db3('laser_blank_scans')


@case
def laser_half_turns():  # each message has one half of the turn
    def change(i, t, m):
        first = i % 2 == 0
        m['ranges'] = m['ranges'][:180] if first else m['ranges'][180:]
        if not first:
            m['amin'] = m['amin'] + 180 * m['inc']
        m['amax'] = m['amin'] + 179 * m['inc']
        return m
    return with_scans(change).db3('laser_half_turns')


@case
def laser_degrees():
    def change(i, t, m):
        m.update(amin=-180.0, amax=179.0, inc=1.0)
        return m
    return with_scans(change).mcap('laser_degrees')


@case
def laser_angle_limits_swapped():  # angle_min > angle_max, the increment positive, ranges counter-clockwise
    def change(i, t, m):
        m['amin'], m['amax'] = math.pi, -math.pi
        m['ranges'] = m['ranges'][180:] + m['ranges'][:180]
        m['amin'] = 0.0
        m['amax'] = -2 * math.pi
        return m
    return with_scans(change).db3('laser_angle_limits_swapped')


@case
def laser_increment_wrong():  # the increment is for half of the beams: they would span two turns
    def change(i, t, m):
        m['inc'] = 2 * m['inc']
        return m
    return with_scans(change).db3('laser_increment_wrong')


@case
def laser_narrow():
    def change(i, t, m):
        m['ranges'] = [NAN if r > 4 or r < 0.45 else r for r in m['ranges'][151:209]]
        m.update(amin=m['amin'] + 151 * m['inc'], amax=m['amin'] + 208 * m['inc'], rmin=0.45, rmax=4.0)
        return m
    return with_scans(change).db3('laser_narrow')


@case
def laser_two_topics():
    _, _, rear = floor.drive('back', mount=BACK['mount'])
    front = plain(scan_topic='/scan_front', laser='front_laser',
                  static=[('base_link', 'front_laser', (0.15, 0, 0.2), (0, 0, 0, 1)),
                          ('base_link', 'rear_laser') + compose((-0.2, 0, math.pi))])
    messages = front.messages()
    for t, ranges in rear:
        messages.append((int((T0 + t + 0.03) * 1e9), '/scan_rear',
                         rg.laser_scan(Cdr, T0 + t, 'rear_laser', -math.pi, math.pi, 2 * math.pi / 360, 0, 0.2, 0.05, 12.0,
                                       ranges)))
    topics = front.topics()
    topics['/scan_rear'] = topics['/scan_front']
    return write('laser_two_topics', messages, topics)


@case
def laser_merged_frames_alternate():  # two drivers with one frame name: front and rear scans alternate
    _, _, rear = floor.drive('back', mount=BACK['mount'])

    def change(i, t, m):
        if i % 2:
            m['ranges'] = rear[i][1]
        return m
    return with_scans(change).db3('laser_merged_frames_alternate')


@case
def laser_slow_2hz(): return plain(scans_every=10).db3('laser_slow_2hz')


@case
def robots_share_topics():  # two robots in one namespace: frames tell them apart
    _, odometry, scans = floor.drive('std')
    recording = plain(base='a/base_link', odom_frame='a/odom', laser='a/laser',
                      static=[('a/base_link', 'a/laser', (0.15, 0, 0.2), (0, 0, 0, 1)),
                              ('b/base_link', 'b/laser', (0.15, 0, 0.2), (0, 0, 0, 1))])
    messages = recording.messages()
    for (t, *_), (_, x, y, yaw) in zip(odometry[::2], odometry[::-2]):
        messages.append((int((T0 + t) * 1e9 + 3e6), '/odom',
                         rg.odometry(Cdr, T0 + t, 'b/odom', 'b/base_link', x, y, rg.quat(yaw))))
    for (t, _), (_, ranges) in zip(scans[::2], scans[::-2]):
        messages.append((int((T0 + t) * 1e9 + 25e6), '/scan',
                         rg.laser_scan(Cdr, T0 + t, 'b/laser', -math.pi, math.pi, 2 * math.pi / 360, 0, 0.2, 0.05, 12.0,
                                       ranges)))
    return write('robots_share_topics', messages, recording.topics())


@case
def robots_odometry_of_other_only():  # scans of one robot, odometry of another
    recording = plain(scan_topic='/a/scan', odom_topic='/b/odom', base='b/base_link', odom_frame='b/odom', laser='a/laser',
                      static=None)
    return recording.db3('robots_odometry_of_other_only')
