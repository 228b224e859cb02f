"""More odd lasers: what the scene or the driver does to ranges."""
from common import *  # noqa: F403
import floor


@case
def laser_sees_robot():  # 40 beams end at the robot's own mast
    def change(i, t, m):
        m['ranges'] = [0.22 + 0.002 * (k % 3) if 160 <= k < 200 else r for k, r in enumerate(m['ranges'])]
        return m
    return with_scans(change, **BACK, static=[BACK_TF]).db3('laser_sees_robot')


@case
def laser_sees_two_posts():  # posts of a frame at both sides
    def change(i, t, m):
        m['ranges'] = [0.35 if k % 90 < 6 else r for k, r in enumerate(m['ranges'])]
        return m
    return with_scans(change).mcap('laser_sees_two_posts')


@case
def laser_36_beams():
    def change(i, t, m):
        m['ranges'] = m['ranges'][::10]
        m['inc'] *= 10
        m['amax'] = m['amin'] + 35 * m['inc']
        return m
    return with_scans(change).db3('laser_36_beams')


@case
def laser_half_missing():
    rnd = random.Random(9)

    def change(i, t, m):
        m['ranges'] = [NAN if rnd.random() < 0.5 else r for r in m['ranges']]
        return m
    return with_scans(change).db3('laser_half_missing')


@case
def laser_noise_5cm():
    rnd = random.Random(9)

    def change(i, t, m):
        m['ranges'] = [r + rnd.gauss(0, 0.05) for r in m['ranges']]
        return m
    return with_scans(change).db3('laser_noise_5cm')


@case
def laser_steps_of_10cm():
    def change(i, t, m):
        m['ranges'] = [0.1 * round(r / 0.1) for r in m['ranges']]
        return m
    return with_scans(change).db3('laser_steps_of_10cm')


@case
def laser_people():  # three people walk beside the robot
    rnd = random.Random(9)
    walkers = [[rnd.uniform(0, 360), rnd.uniform(0.8, 2.5), rnd.uniform(-2, 2)] for _ in range(3)]

    def change(i, t, m):
        ranges = list(m['ranges'])
        for w in walkers:
            w[0] = (w[0] + w[2]) % 360
            half = int(math.degrees(0.25 / w[1]))
            for k in range(int(w[0]) - half, int(w[0]) + half + 1):
                ranges[k % 360] = min(ranges[k % 360], w[1] + rnd.gauss(0, 0.01))
        m['ranges'] = ranges
        return m
    return with_scans(change).db3('laser_people')


@case
def laser_freezes():  # the driver repeats one scan with new stamps for 8 s
    held = []

    def change(i, t, m):
        if 60 < t < 68:
            held.append(m['ranges'])
            m['ranges'] = held[0]
        return m
    return with_scans(change).db3('laser_freezes')


@case
def laser_beams_change():  # 360 beams, then 180
    def change(i, t, m):
        if t > 80:
            m['ranges'] = m['ranges'][::2]
            m['inc'] *= 2
            m['amax'] = m['amin'] + 179 * m['inc']
        return m
    return with_scans(change).db3('laser_beams_change')


@case
def laser_field_changes():  # the whole turn, then 180 degrees
    def change(i, t, m):
        if t > 80:
            m['ranges'] = m['ranges'][90:271]
            m['amin'] += 90 * m['inc']
            m['amax'] = m['amin'] + 180 * m['inc']
        return m
    return with_scans(change).mcap('laser_field_changes')


@case
def laser_frame_renamed():  # the name of the frame changes in the middle
    def change(i, t, m):
        if t > 80:
            m['frame'] = 'laser_link'
        return m
    return with_scans(change).db3('laser_frame_renamed')


@case
def laser_mounting_turned_later():  # a person turns the laser round at 80 s, and its frame tells it
    _, _, rear = floor.drive('back', mount=BACK['mount'])

    def change(i, t, m):
        if t > 80:
            m['frame'], m['ranges'] = 'rear_laser', rear[i][1]
        return m
    return with_scans(change, static=[FRONT_TF, ('base_link', 'rear_laser') + compose((-0.2, 0, math.pi))]).db3(
        'laser_mounting_turned_later')


@case
def laser_mounting_turned_later_untold():
    _, _, rear = floor.drive('back', mount=BACK['mount'])

    def change(i, t, m):
        if t > 80:
            m['ranges'] = rear[i][1]
        return m
    return with_scans(change).db3('laser_mounting_turned_later_untold')


@case
def laser_maximum_too_small():  # range_max says 2 m, the readings go on to 12 m
    def change(i, t, m):
        m['rmax'] = 2.0
        return m
    return with_scans(change).db3('laser_maximum_too_small')


@case
def laser_minimum_too_large():  # range_min says 3 m
    def change(i, t, m):
        m['rmin'] = 3.0
        return m
    return with_scans(change).db3('laser_minimum_too_large')


@case
def laser_maximum_and_minimum_swapped():
    def change(i, t, m):
        m['rmin'], m['rmax'] = m['rmax'], m['rmin']
        return m
    return with_scans(change).db3('laser_maximum_and_minimum_swapped')


@case
def laser_frame_empty():
    def change(i, t, m):
        m['frame'] = ''
        return m
    return with_scans(change, **BACK, static=[BACK_TF]).db3('laser_frame_empty')


@case
def laser_end_is_two_pi():  # 360 readings from -pi to pi, the step as if both ends were measured
    def change(i, t, m):
        m['amax'] = m['amin'] + 2 * math.pi
        m['inc'] = 2 * math.pi / 359
        return m
    return with_scans(change).db3('laser_end_is_two_pi')


@case
def laser_angle_offset():  # the zero of the driver is 30 degrees off, the transform does not know it
    def change(i, t, m):
        m['ranges'] = m['ranges'][30:] + m['ranges'][:30]
        return m
    return with_scans(change).db3('laser_angle_offset')


@case
def laser_transform_wrong_180():  # the transform says ahead, the laser looks back
    return plain(static=[FRONT_TF], **BACK).db3('laser_transform_wrong_180')


@case
def laser_transform_wrong_90():
    return plain(drive='left', mount=(0.1, 0.05, math.pi / 2, False), static=[FRONT_TF]).db3('laser_transform_wrong_90')


@case
def laser_transform_upside_down_wrong():  # the transform says upside down, the laser is upright
    return plain(static=[('base_link', 'laser') + compose((0.15, 0.0, 0.0), roll=math.pi)]).db3(
        'laser_transform_upside_down_wrong')


@case
def laser_transform_millimetres():
    return plain(static=[('base_link', 'laser', (150.0, 0, 200.0), (0, 0, 0, 1))]).db3('laser_transform_millimetres')


@case
def laser_transform_zero_quaternion():
    return plain(static=[('base_link', 'laser', (-0.2, 0, 0.2), (0, 0, 0, 0))], **BACK).db3('laser_transform_zero_quaternion')


@case
def laser_transform_nan():
    return plain(static=[('base_link', 'laser', (NAN, 0, 0.2), (0, 0, NAN, 1))], **BACK).db3('laser_transform_nan')


@case
def laser_transform_inverse():  # child and parent are exchanged
    return plain(static=[('laser', 'base_link') + compose((-0.2, 0, math.pi))], **BACK).db3('laser_transform_inverse')


@case
def laser_scan_stamps_late():  # stamped at reception, 0.25 s after the sweep, with jitter
    rnd = random.Random(2)
    return plain(scan_stamp=lambda i, t: T0 + t + rnd.uniform(0.15, 0.35)).db3('laser_scan_stamps_late')


@case
def laser_offset_of_range():  # each range is 0.12 m too long
    def change(i, t, m):
        m['ranges'] = [r + 0.12 for r in m['ranges']]
        return m
    return with_scans(change).db3('laser_offset_of_range')


@case
def laser_feet():
    def change(i, t, m):
        m['ranges'] = [3.2808 * r for r in m['ranges']]
        m['rmax'] = 40.0
        return m
    return with_scans(change).db3('laser_feet')


@case
def laser_ranges_long():
    """Each range is 8 % too long, and odometry is right."""
    def change(i, t, m):
        m['ranges'] = [1.08 * r for r in m['ranges']]
        return m
    return with_scans(change).db3('laser_ranges_long')
