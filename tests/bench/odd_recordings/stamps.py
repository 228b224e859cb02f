"""Odd stamps and clocks."""
from common import *  # noqa: F403


@case
def stamps_odometry_all_zero(): return plain(odom_stamp=lambda i, t: 0.0).db3('stamps_odometry_all_zero')


@case
def stamps_scans_all_zero(): return plain(scan_stamp=lambda i, t: 0.0).mcap('stamps_scans_all_zero')


@case
def stamps_all_zero():
    return plain(scan_stamp=lambda i, t: 0.0, odom_stamp=lambda i, t: 0.0).bag('stamps_all_zero')


@case
def stamps_one_scan_ahead():
    return plain(scan_stamp=lambda i, t: T0 + t + (3e7 if i == 300 else 0)).db3('stamps_one_scan_ahead')


@case
def stamps_ten_scans_1970():
    return plain(scan_stamp=lambda i, t: t if 300 <= i < 310 else T0 + t).mcap('stamps_ten_scans_1970')


@case
def stamps_whole_seconds():
    return plain(scan_stamp=lambda i, t: math.floor(T0 + t), odom_stamp=lambda i, t: math.floor(T0 + t)).db3(
        'stamps_whole_seconds')


@case
def stamps_odometry_whole_seconds():
    return plain(odom_stamp=lambda i, t: math.floor(T0 + t)).db3('stamps_odometry_whole_seconds')


@case
def stamps_odometry_clock_back():
    return plain(odom_stamp=lambda i, t: T0 + t - (10 if t > 80 else 0)).db3('stamps_odometry_clock_back')


@case
def stamps_scan_clock_ahead_later():
    return plain(scan_stamp=lambda i, t: T0 + t + (3600 if t > 80 else 0)).mcap('stamps_scan_clock_ahead_later')


@case
def stamps_simulated_from_zero():
    return plain(t0=0.0, log0=T0).db3('stamps_simulated_from_zero')


@case
def stamps_ntp_at_start():  # both clocks begin in 1970 and are set after 5 s
    def stamp(_, t): return T0 + t if t > 5 else t
    return plain(scan_stamp=stamp, odom_stamp=stamp).db3('stamps_ntp_at_start')


@case
def stamps_zero_now_and_then():
    return plain(scan_stamp=lambda i, t: 0.0 if i % 50 == 7 else T0 + t,
                 odom_stamp=lambda i, t: 0.0 if i % 70 == 9 else T0 + t).mcap('stamps_zero_now_and_then')


@case
def stamps_shuffled():  # the recorder stored messages of 0.1 s in disorder
    rnd = random.Random(3)
    recording = plain()
    messages = [(int(m[0] + rnd.uniform(0, 1e8)), m[1], m[2]) for m in recording.messages()]
    return write('stamps_shuffled', messages)
