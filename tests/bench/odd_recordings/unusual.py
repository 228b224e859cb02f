"""Unusual lasers, odometry and containers that the other files do not have."""
import struct

from carmen_logs import carmen, flaser
from common import *  # noqa: F403


@case
def unusual_3600_beams():
    amin, inc = -math.pi, 2 * math.pi / 3600

    def change(i, t, m):
        m.update(ranges=[r for r in m['ranges'] for _ in range(10)], inc=inc, amin=amin - 4.5 * inc)
        m['amax'] = m['amin'] + 3599 * inc
        return m
    return with_scans(change).db3('unusual_3600_beams')


@case
def unusual_12_beams():
    def change(i, t, m):
        m.update(ranges=m['ranges'][::30], inc=30 * m['inc'])
        m['amax'] = m['amin'] + 11 * m['inc']
        return m
    return with_scans(change).db3('unusual_12_beams')


@case
def unusual_salt():  # one reading in ten is anywhere
    rnd = random.Random(8)

    def change(i, t, m):
        m['ranges'] = [rnd.uniform(0.1, 11.0) if rnd.random() < 0.1 else r for r in m['ranges']]
        return m
    return with_scans(change).db3('unusual_salt')


@case
def unusual_dirty_sector():  # 40 degrees of the window are dirty: 0.12 m
    def change(i, t, m):
        m['ranges'] = [0.12 if 90 <= k < 130 else r for k, r in enumerate(m['ranges'])]
        return m
    return with_scans(change).db3('unusual_dirty_sector')


@case
def unusual_laser_tilted():  # 6 degrees nose down, said by the transform
    return plain(static=[('base_link', 'laser', (0.15, 0, 0.2), rg.quat(0.0, 0.0, 0.1))]).db3('unusual_laser_tilted')


@case
def unusual_deep_frames():
    chain = [('base_link', 'plate', (0.1, 0, 0.1), rg.quat(math.pi / 2)), ('plate', 'mast', (0, -0.05, 0.1), rg.quat(-math.pi / 2)),
             ('mast', 'laser_mount', (0, 0, 0), (0, 0, 0, 1)), ('laser_mount', 'laser', (0, 0, 0), (0, 0, 0, 1))]
    return plain(static=chain).mcap('unusual_deep_frames')


@case
def unusual_cycle_of_frames():
    loop = [('base_link', 'laser', (0.15, 0, 0.2), (0, 0, 0, 1)), ('laser', 'cam', (0, 0, 0), (0, 0, 0, 1)),
            ('cam', 'base_link', (0, 0, 0), (0, 0, 0, 1))]
    return plain(static=loop).db3('unusual_cycle_of_frames')


@case
def unusual_names():  # spaces, letters beyond ASCII and 300 bytes
    laser = 'läser ' + 'x' * 300
    return plain(laser=laser, static=[('base_link', laser, (0.15, 0, 0.2), (0, 0, 0, 1))]).db3('unusual_names')


@case
def unusual_control_codes():
    laser = 'la\x1b[31mser\nx'
    return plain(laser=laser, static=[('base_link', laser, (0.15, 0, 0.2), (0, 0, 0, 1))]).db3('unusual_control_codes')


@case
def unusual_quaternion_signs():
    def flipped(a):
        q = rg.quat(a)
        flipped.n += 1
        return tuple(-v for v in q) if flipped.n % 2 else q
    flipped.n = 0
    return plain(quat=flipped).db3('unusual_quaternion_signs')


@case
def unusual_odometry_units_change():  # metres, then centimetres from 80 s on
    return odometry_from('unusual_odometry_units_change',
                         poses(lambda i, t, x, y, a: (x, y, a) if t < 80 else (100 * x, 100 * y, a)))


@case
def unusual_odometry_mirrored_later():
    return odometry_from('unusual_odometry_mirrored_later',
                         poses(lambda i, t, x, y, a: (x, y, a) if t < 80 else (x, -y, -a)))


@case
def unusual_odometry_slips():  # each tenth metre counts double
    total = [0.0, 0.0, None]

    def pose(i, t, x, y, a):
        if total[2]:
            px, py = total[2]
            d = math.hypot(x - px, y - py)
            k = 2.0 if int(math.hypot(x, y) * 2) % 5 == 0 else 1.0
            total[0] += k * (x - px)
            total[1] += k * (y - py)
            assert d < 1
        total[2] = (x, y)
        return total[0], total[1], a
    return odometry_from('unusual_odometry_slips', poses(pose))


@case
def unusual_odometry_waves():  # a heading that swings by 5 degrees
    return odometry_from('unusual_odometry_waves', poses(lambda i, t, x, y, a: (x, y, a + 0.09 * math.sin(2 * t))))


@case
def unusual_odometry_lags():  # the filter of the driver is 0.4 s late
    def function(i, t, x, y, a):
        return [(T0 + t + 0.4, x, y, a)]
    return odometry_from('unusual_odometry_lags', function)


@case
def unusual_odometry_bursts():  # 20 poses each second, in the first 0.1 s of it
    return odometry_from('unusual_odometry_bursts',
                         lambda i, t, x, y, a: [(T0 + int(t) + (t - int(t)), x, y, a)] if t - int(t) < 0.3 else None)


@case
def unusual_odometry_third():  # one message of three is of another robot's odometry, same frames
    return odometry_from('unusual_odometry_third',
                         poses(lambda i, t, x, y, a: (x + 40, y - 20, a + 1) if i % 3 == 0 else (x, y, a)))


@case
def unusual_stands_first():  # a minute without motion, then the drive
    recording = plain()
    messages = recording.messages()
    first = next(m for m in messages if m[1] == '/scan')
    still = []
    _, _, scans = floor.drive('std')
    rnd = random.Random(2)
    for i in range(300):
        t = T0 - 60 + 0.2 * i
        ranges = [r + rnd.gauss(0, 0.01) for r in scans[0][1]]
        still.append((int(t * 1e9), '/scan', rg.laser_scan(Cdr, t, 'laser', -math.pi, math.pi, 2 * math.pi / 360, 0, 0.2, 0.05,
                                                           12.0, ranges)))
        still.append((int(t * 1e9), '/odom', rg.odometry(Cdr, t, 'odom', 'base_link', 0.0, 0.0, (0, 0, 0, 1))))
    assert first
    return write('unusual_stands_first', still + messages)


@case
def unusual_pause_of_an_hour():  # switched off, pushed nowhere, switched on: odometry from zero
    reset = rebased([80.0])

    def function(i, t, x, y, a):
        return [(stamp + (3600 if t >= 80 else 0), *rest) for stamp, *rest in reset(i, t, x, y, a)]
    _, odometry, scans = floor.drive('std')
    messages = [m for m in plain().messages() if m[1] not in ('/odom', '/scan')]
    for i, (t, x, y, a) in enumerate(odometry):
        for stamp, *pose in function(i, t, x, y, a):
            messages.append((int(stamp * 1e9), '/odom', rg.odometry(Cdr, stamp, 'odom', 'base_link', pose[0], pose[1],
                                                                    rg.quat(pose[2]))))
    for t, ranges in scans:
        stamp = T0 + t + (3600 if t >= 80 else 0)
        messages.append((int(stamp * 1e9) + 1, '/scan', rg.laser_scan(Cdr, stamp, 'laser', -math.pi, math.pi,
                                                                       2 * math.pi / 360, 0, 0.2, 0.05, 12.0, ranges)))
    return write('unusual_pause_of_an_hour', messages)


@case
def unusual_db3_topic_twice():  # two publishers: two rows of one topic
    import sqlite3
    path = plain().db3('unusual_db3_topic_twice')
    db = sqlite3.connect(path)
    columns = [row[1] for row in db.execute('PRAGMA table_info(topics)')][1:]
    db.execute('INSERT INTO topics(%s) SELECT %s FROM topics WHERE name="/scan"' % (','.join(columns), ','.join(columns)))
    number = db.execute('SELECT max(id) FROM topics').fetchone()[0]
    scan = db.execute('SELECT min(id) FROM topics WHERE name="/scan"').fetchone()[0]
    db.execute('UPDATE messages SET topic_id=? WHERE topic_id=? AND id%2=0', (number, scan))
    db.commit()
    db.close()
    return path


@case
def unusual_db3_empty_messages():  # each twentieth is empty, each thirtieth cut
    import sqlite3
    path = plain().db3('unusual_db3_empty_messages')
    db = sqlite3.connect(path)
    db.execute("UPDATE messages SET data=x'' WHERE id%20=3")
    db.execute('UPDATE messages SET data=substr(data,1,40) WHERE id%30=7')
    db.commit()
    db.close()
    return path


@case
def unusual_mcap_flipped_bits():
    path = plain().mcap('unusual_mcap_flipped_bits')
    data = bytearray(open(path, 'rb').read())
    rnd = random.Random(4)
    for _ in range(20):
        data[rnd.randrange(len(data) // 3, len(data) * 2 // 3)] ^= 1 << rnd.randrange(8)
    open(path, 'wb').write(data)
    return path


@case
def unusual_bag_flipped_bits():
    path = plain().bag('unusual_bag_flipped_bits')
    data = bytearray(open(path, 'rb').read())
    rnd = random.Random(6)
    for _ in range(20):
        data[rnd.randrange(len(data) // 3, len(data) * 2 // 3)] ^= 1 << rnd.randrange(8)
    open(path, 'wb').write(data)
    return path


@case
def unusual_scans_only_between():  # scans only while the robot turns
    _, odometry, scans = floor.drive('std')
    turning = {round(t1, 3) for (t0, _, _, a0), (t1, _, _, a1) in zip(odometry, odometry[1:])
               if abs(math.remainder(a1 - a0, 2 * math.pi)) > 0.01}

    def change(i, t, m): return m if round(t, 3) in turning else []
    return with_scans(change).db3('unusual_scans_only_between')


@case
def unusual_two_rates():  # stamps of the scans run 0.5 % fast
    return plain(scan_stamp=lambda i, t: T0 + 1.005 * t).db3('unusual_two_rates')


@case
def unusual_ranges_short():
    def change(i, t, m):
        m['ranges'] = [0.9 * r for r in m['ranges']]
        return m
    return with_scans(change).db3('unusual_ranges_short')


@case
def unusual_angles_short():  # 270 degrees are stated for a turn of 360
    def change(i, t, m):
        m['inc'] *= 0.75
        m['amin'] *= 0.75
        m['amax'] = m['amin'] + 359 * m['inc']
        return m
    return with_scans(change).db3('unusual_angles_short')


@case
def unusual_glass_and_no_odometry():
    rnd = random.Random(9)

    def change(i, t, m):
        m['ranges'] = [NAN if rnd.random() < 0.4 else r for r in m['ranges']]
        return m
    return with_scans(change, odom=False).db3('unusual_glass_and_no_odometry')


@case
def unusual_inches():
    def change(i, t, m):
        m['ranges'] = [r / 0.0254 for r in m['ranges']]
        m['rmax'] = 480.0
        return m
    return with_scans(change).db3('unusual_inches')


@case
def unusual_carmen_tabs():
    return carmen('unusual_carmen_tabs', lambda i, t, b, lx, ly, a, x, y:
                  ['  ' + flaser(b, lx, ly, a, x, y, t).replace(' ', '\t') + ' '])


@case
def unusual_carmen_exponents():
    return carmen('unusual_carmen_exponents', lambda i, t, b, lx, ly, a, x, y:
                  [flaser(b, lx, ly, a, x, y, t, form='%.5e')])


@case
def unusual_carmen_lower_case():
    return carmen('unusual_carmen_lower_case', lambda i, t, b, lx, ly, a, x, y:
                  [flaser(b, lx, ly, a, x, y, t, word='flaser')])


@case
def unusual_carmen_commas():
    return carmen('unusual_carmen_commas', lambda i, t, b, lx, ly, a, x, y:
                  [flaser(b, lx, ly, a, x, y, t).replace(' ', ',')])


@case
def unusual_carmen_no_host():
    return carmen('unusual_carmen_no_host', lambda i, t, b, lx, ly, a, x, y:
                  [flaser(b, lx, ly, a, x, y, t).replace(' robot', '')])


@case
def unusual_carmen_nul_bytes():
    return carmen('unusual_carmen_nul_bytes', lambda i, t, b, lx, ly, a, x, y:
                  [flaser(b, lx, ly, a, x, y, t), 'ODOM \0\0\0' if i % 50 == 0 else '# .'])


@case
def unusual_csv():
    return carmen('unusual_csv', lambda i, t, b, lx, ly, a, x, y:
                  ['%.3f,%.3f,%.3f,%.3f,' % (t, x, y, a) + ','.join('%.3f' % r for r in b)], ['time,x,y,theta,ranges'])


@case
def unusual_raw_laser():
    return carmen('unusual_raw_laser', lambda i, t, b, lx, ly, a, x, y:
                  ['ODOM %f %f %f 0 0 0 %f robot %f' % (x, y, a, t, t - T0),
                   'RAWLASER1 0 -1.5708 3.14159 0.0174533 80 0.01 0 %d %s 0 %f robot %f' %
                   (len(b), ' '.join('%.3f' % r for r in b), t, t - T0)])


@case
def unusual_g2o():
    path = OUT + '/unusual_g2o.g2o'
    open(path, 'w').write('VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n' * 50)
    return path


@case
def unusual_pcd():
    path = OUT + '/unusual_pcd.pcd'
    open(path, 'wb').write(b'# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 10\nHEIGHT 1\n'
                           b'POINTS 10\nDATA binary\n' + struct.pack('<30f', *range(30)))
    return path
