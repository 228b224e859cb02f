"""Odd files."""
import bz2
import gzip
import struct

from common import *  # noqa: F403


@case
def file_bag_bz2():
    path = Rec(tf=False).bag('file_bag_bz2')
    data = open(path, 'rb').read()
    out, at = [data[:13]], 13
    while at < len(data):
        size = struct.unpack('<I', data[at:at + 4])[0]
        head = data[at + 4:at + 4 + size]
        length = struct.unpack('<I', data[at + 4 + size:at + 8 + size])[0]
        body = data[at + 8 + size:at + 8 + size + length]
        if b'compression=none' in head:
            packed = bz2.compress(body)
            fields = rg._hdr(op=b'\x05', compression=b'bz2', size=struct.pack('<I', length))
            out.append(fields + struct.pack('<I', len(packed)) + packed)
        else:
            out.append(data[at:at + 8 + size + length])
        at += 8 + size + length
    open(path, 'wb').write(b''.join(out))
    return path


@case
def file_bag_gz():
    path = Rec(tf=False).bag('file_bag_gz')
    with gzip.open(path + '.gz', 'wb') as packed:
        packed.write(open(path, 'rb').read())
    return path + '.gz'


@case
def file_db3_cut():
    path = Rec(tf=False).db3('file_db3_cut')
    data = open(path, 'rb').read()
    open(path, 'wb').write(data[:len(data) // 2])
    return path


@case
def file_bag_cut():
    path = Rec(tf=False).bag('file_bag_cut')
    data = open(path, 'rb').read()
    open(path, 'wb').write(data[:len(data) * 2 // 3])
    return path


@case
def file_mcap_holes():  # a part in the middle is zeros
    path = Rec(tf=False).mcap('file_mcap_holes')
    data = bytearray(open(path, 'rb').read())
    at = len(data) // 2
    data[at:at + 4096] = bytes(4096)
    open(path, 'wb').write(data)
    return path


@case
def file_topics_reversed():  # topic after topic, odometry last
    recording = plain()
    messages = recording.messages()
    order = {'/scan': 1, '/odom': 2, '/tf_static': 3}
    messages.sort(key=lambda m: (order[m[1]], m[0]))
    path = OUT + '/file_topics_reversed.mcap'
    rg.write_mcap(path, messages, recording.topics())
    return path
