"""Other encodings of messages, and other containers."""
import json
import lzma
import shutil
import sqlite3
import struct
import tarfile
import zipfile

from common import *  # noqa: F403
import floor


class BigCdr(Cdr):
    """CDR of a big-endian machine."""
    def num(self, fmt, *v):
        size = struct.calcsize(fmt)
        for x in v:
            self.al(size)
            self.b += struct.pack('>' + fmt, x)

    def seq(self, fmt, vs):
        self.num('I', len(vs))
        for v in vs:
            self.num(fmt, v)

    def done(self): return b'\0\0\0\0' + bytes(self.b)


class Xcdr2(Cdr):
    """Plain CDR of version 2: numbers of 8 bytes are aligned to 4."""
    def al(self, n): Cdr.al(self, min(n, 4))

    def done(self):
        self.b += bytes(-len(self.b) % 4)
        return b'\0\7\0\0' + bytes(self.b)


@case
def encoding_big_endian(): return plain(E=BigCdr).db3('encoding_big_endian')


@case
def encoding_xcdr2(): return plain(E=Xcdr2).mcap('encoding_xcdr2')


@case
def encoding_short_type_names():  # sensor_msgs/LaserScan with CDR, as converters write it
    recording = plain()
    path = OUT + '/encoding_short_type_names.db3'
    rg.write_db3(path, recording.messages(), recording.topics(True))
    return path


@case
def encoding_foxy():  # the first schema: no tables of the schema and of metadata, topics without QoS
    path = plain().db3('encoding_foxy')
    db = sqlite3.connect(path)
    db.executescript('DROP TABLE schema; DROP TABLE metadata; CREATE TABLE t2(id INTEGER PRIMARY KEY, name TEXT NOT NULL,'
                     ' type TEXT NOT NULL, serialization_format TEXT NOT NULL);'
                     ' INSERT INTO t2 SELECT id,name,type,serialization_format FROM topics; DROP TABLE topics;'
                     ' ALTER TABLE t2 RENAME TO topics;')
    db.commit()
    db.close()
    return path


@case
def encoding_jazzy_schema():
    path = plain().db3('encoding_jazzy_schema')
    db = sqlite3.connect(path)
    db.executescript('UPDATE schema SET schema_version=4, ros_distro="jazzy";'
                     ' ALTER TABLE topics ADD COLUMN type_description_hash TEXT NOT NULL DEFAULT "";'
                     ' CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT'
                     ' NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);')
    db.commit()
    db.close()
    return path


@case
def encoding_rows_in_disorder():  # as a merge of two .db3 leaves them: by number, not by time
    recording = plain()
    messages = recording.messages()
    path = OUT + '/encoding_rows_in_disorder.db3'
    rg.write_db3(path, messages[len(messages) // 2:] + messages[:len(messages) // 2], recording.topics())
    return path


@case
def encoding_mcap_disorder():
    recording = plain()
    messages = recording.messages()
    path = OUT + '/encoding_mcap_disorder.mcap'
    rg.write_mcap(path, messages[len(messages) // 2:] + messages[:len(messages) // 2], recording.topics())
    return path


@case
def encoding_log_times_zero():  # a converter without times of reception
    recording = plain()
    messages = [(0, m[1], m[2]) for m in recording.messages()]
    path = OUT + '/encoding_log_times_zero.mcap'
    rg.write_mcap(path, messages, recording.topics())
    return path


@case
def encoding_log_times_seconds():  # times of reception in seconds in place of nanoseconds
    recording = plain()
    messages = [(m[0] // 10**9, m[1], m[2]) for m in recording.messages()]
    path = OUT + '/encoding_log_times_seconds.db3'
    rg.write_db3(path, messages, recording.topics())
    return path


@case
def encoding_mcap_json():  # Foxglove's own types as JSON
    _, odometry, scans = floor.drive('std')
    messages = []
    for t, ranges in scans:
        messages.append((int((T0 + t) * 1e9), '/scan', json.dumps(
            {'timestamp': {'sec': int(T0 + t), 'nsec': 0}, 'frame_id': 'laser', 'start_angle': -3.14, 'end_angle': 3.14,
             'ranges': ranges, 'intensities': []}).encode()))
    path = OUT + '/encoding_mcap_json.mcap'
    rg.write_mcap(path, messages, {'/scan': 'foxglove.LaserScan'}, encoding='json', schema='jsonschema', profile='')
    return path


@case
def encoding_mcap_idl():  # ros2idl definitions in place of ros2msg
    recording = plain()
    path = OUT + '/encoding_mcap_idl.mcap'
    rg.write_mcap(path, recording.messages(), recording.topics(), schema='ros2idl')
    return path


def misnamed(name, path, new):
    target = '%s/%s%s' % (OUT, name, new)
    os.replace(path, target)
    return target


@case
def encoding_mcap_named_bag(): return misnamed('encoding_mcap_named_bag', plain().mcap('named_x'), '.bag')


@case
def encoding_db3_named_mcap(): return misnamed('encoding_db3_named_mcap', plain().db3('named_y'), '.mcap')


@case
def encoding_bag_active(): return misnamed('encoding_bag_active', plain().bag('named_z'), '.bag.active')


@case
def encoding_bag_no_suffix(): return misnamed('encoding_bag_no_suffix', plain().bag('named_w'), '')


@case
def encoding_bag_xz():
    path = plain().bag('encoding_bag_xz')
    with lzma.open(path + '.xz', 'wb', preset=0) as packed:
        packed.write(open(path, 'rb').read())
    return path + '.xz'


@case
def encoding_db3_zip():
    path = plain().db3('encoding_db3_zip')
    with zipfile.ZipFile(path[:-4] + '.zip', 'w', zipfile.ZIP_DEFLATED) as packed:
        packed.write(path, 'drive/x_0.db3')
    return path[:-4] + '.zip'


@case
def encoding_tar_gz():
    path = plain().mcap('encoding_tar_gz')
    with tarfile.open(path[:-5] + '.tar.gz', 'w:gz', compresslevel=1) as packed:
        packed.add(path, 'drive/x_0.mcap')
    return path[:-5] + '.tar.gz'


@case
def encoding_folder_of_bags():  # rosbag record --split
    recording = plain(E=Ros1)
    messages = recording.messages()
    folder = OUT + '/encoding_folder_of_bags'
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    third = len(messages) // 3
    for k in range(3):
        part = messages[k * third:] if k == 2 else messages[k * third:(k + 1) * third]
        rg.write_bag('%s/drive_2024_%d.bag' % (folder, k), part, recording.topics(True))
    return folder


@case
def encoding_empty_db3():
    path = OUT + '/encoding_empty_db3.db3'
    open(path, 'wb').close()
    return path


@case
def encoding_no_messages():
    recording = plain()
    path = OUT + '/encoding_no_messages.mcap'
    rg.write_mcap(path, [], recording.topics())
    return path


def lz4_raw(data):
    """An LZ4 frame with blocks that are stored, without checksums."""
    head = bytes([0x60, 0x70])
    out = b'\x04\x22\x4d\x18' + head + bytes([xxh32(head) >> 8 & 0xff])
    for i in range(0, len(data), 4 << 20):
        part = data[i:i + (4 << 20)]
        out += struct.pack('<I', len(part) | 1 << 31) + part
    return out + bytes(4)


def xxh32(data):
    """xxHash of fewer than 16 bytes."""
    p2, p3, p4, p5 = 2246822519, 3266489917, 668265263, 374761393
    h = (p5 + len(data)) & 0xffffffff
    for b in data:
        h = (h + b * p5) & 0xffffffff
        h = ((h << 11 | h >> 21) & 0xffffffff) * 2654435761 & 0xffffffff
    h ^= h >> 15
    h = h * p2 & 0xffffffff
    h ^= h >> 13
    h = h * p3 & 0xffffffff
    return h ^ h >> 16


@case
def encoding_bag_lz4():  # rosbag record --lz4
    path = plain().bag('encoding_bag_lz4')
    data = open(path, 'rb').read()
    out, at = [data[:13]], 13
    while at < len(data):
        size = struct.unpack('<I', data[at:at + 4])[0]
        head = data[at + 4:at + 4 + size]
        length = struct.unpack('<I', data[at + 4 + size:at + 8 + size])[0]
        body = data[at + 8 + size:at + 8 + size + length]
        if b'compression=none' in head:
            packed = lz4_raw(body)
            out.append(rg._hdr(op=b'\x05', compression=b'lz4', size=struct.pack('<I', length)) +
                       struct.pack('<I', len(packed)) + packed)
        else:
            out.append(data[at:at + 8 + size + length])
        at += 8 + size + length
    open(path, 'wb').write(b''.join(out))
    return path


def multi_echo(E, t, frame, ranges):
    e = E()
    e.header(rg.stamp(t), frame)
    e.num('f', -math.pi, math.pi, 2 * math.pi / 360, 0, 0.2, 0.05, 12.0)
    e.num('I', len(ranges))
    for r in ranges:
        e.seq('f', [r, r + 2.0] if int(r * 100) % 9 == 0 else [r])
    e.num('I', 0)
    return e.done()


@case
def encoding_multi_echo():  # Hokuyo with more than one echo
    _, _, scans = floor.drive('std')
    recording = plain(E=Ros1)
    messages = [m for m in recording.messages() if m[1] != '/scan']
    messages += [(int((T0 + t + 0.02) * 1e9), '/echoes', multi_echo(Ros1, T0 + t, 'laser', r)) for t, r in scans]
    messages.sort(key=lambda m: m[0])
    topics = recording.topics(True)
    del topics['/scan']
    topics['/echoes'] = 'sensor_msgs/MultiEchoLaserScan'
    path = OUT + '/encoding_multi_echo.bag'
    rg.write_bag(path, messages, topics)
    return path


@case
def encoding_point_cloud():  # only a point cloud of the laser
    _, _, scans = floor.drive('std')
    recording = plain()
    messages = [m for m in recording.messages() if m[1] != '/scan']
    for t, ranges in scans[::4]:
        e = Cdr()
        e.header(rg.stamp(T0 + t), 'laser')
        e.num('I', 1, len(ranges))
        e.num('I', 0)
        e.num('B', 0)
        e.num('I', 12, 12 * len(ranges))
        e.num('I', 0)
        e.num('B', 1)
        messages.append((int((T0 + t) * 1e9), '/cloud', e.done()))
    topics = recording.topics()
    del topics['/scan']
    topics['/cloud'] = 'sensor_msgs/msg/PointCloud2'
    return write('encoding_point_cloud', messages, topics)
