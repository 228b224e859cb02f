"""Odd frames and transforms."""
from common import *  # noqa: F403


@case
def frames_turned_mount():
    return plain(drive='left', mount=(0.1, 0.05, math.pi / 2, False),
                 static=[('base_link', 'mount', (0.1, 0.05, 0.2), (0, 0, 0, 1)),
                         ('mount', 'laser', (0, 0, 0), rg.quat(math.pi / 2))]).db3('frames_turned_mount')


@case
def frames_turned_mount_unknown():
    return plain(drive='left', mount=(0.1, 0.05, math.pi / 2, False), static=None).db3('frames_turned_mount_unknown')


@case
def frames_backwards_unknown(): return plain(static=None, **BACK).bag('frames_backwards_unknown')


@case
def frames_upside_down_unknown():
    return plain(drive='flip', mount=(0.15, 0.05, 0.0, True), static=None).mcap('frames_upside_down_unknown')


@case
def frames_footprint_without_link():  # the tree does not join base_footprint and base_link
    return plain(child='base_footprint', static=[BACK_TF], **BACK).db3('frames_footprint_without_link')


@case
def frames_static_on_tf():  # static_transform_publisher of ROS 1: again and again on /tf
    recording = Rec(E=Ros1, static=None, **BACK)
    messages = recording.messages()
    for k in range(0, 1750):
        t = T0 + 0.1 * k
        messages.append((int(t * 1e9), '/tf', rg.tf(Ros1, [(t, 'base_link', 'laser') + compose((-0.2, 0, math.pi))])))
    messages.sort(key=lambda m: m[0])
    path = OUT + '/frames_static_on_tf.bag'
    rg.write_bag(path, messages, recording.topics(True))
    return path


@case
def frames_map_to_odom():  # a localization moves odom in map now and then; no /odom
    recording = Rec(odom=False)
    messages = recording.messages()
    for k in range(0, 175):
        t = T0 + k
        messages.append((int(t * 1e9), '/tf', rg.tf(Cdr, [(t, 'map', 'odom', (0.02 * (k % 7), 0.5, 0), rg.quat(0.1))])))
    return write('frames_map_to_odom', messages, recording.topics())


@case
def frames_map_to_base_only():  # transforms of a SLAM without odometry
    recording = Rec(odom=False, odom_frame='map')
    return recording.db3('frames_map_to_base_only')


@case
def frames_two_statics():  # an old transform of the laser is published too, and replaced
    recording = plain(static=None, **BACK)
    messages = recording.messages()
    messages.append((int(T0 * 1e9), '/tf_static', rg.tf(Cdr, [(T0, *FRONT_TF)])))
    messages.append((int((T0 + 0.5) * 1e9), '/tf_static', rg.tf(Cdr, [(T0, *BACK_TF)])))
    topics = plain().topics()
    return write('frames_two_statics', messages, topics)


@case
def frames_second_robot_on_tf():  # /tf of two robots with prefixes, scans and odometry of one
    recording = Rec(odom_frame='a/odom', base='a/base_link', laser='a/laser', odom=False, scan_topic='/a/scan',
                    static=[('a/base_link', 'a/laser', (0.15, 0, 0.2), (0, 0, 0, 1))])
    messages = recording.messages()
    _, odometry, _ = floor.drive('std')
    for (t, *_), (_, x, y, yaw) in zip(odometry, odometry[::-1]):
        messages.append((int((T0 + t) * 1e9), '/tf',
                         rg.tf(Cdr, [(T0 + t, 'b/odom', 'b/base_link', (x, y, 0), rg.quat(yaw))])))
    return write('frames_second_robot_on_tf', messages, recording.topics())
