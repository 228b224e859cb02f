#!/usr/bin/env python3
"""packets.py ROBOT LOG COMMAND...: runs the command, which maps the log for the robot, and prints what a listener at
the interface lo of this network namespace can read, one thing a line. Needs root."""

import re
import select
import socket
import struct
import subprocess
import sys

# Plain by the specification of DDS security (1.1, 7.3.7 and 8.3): participants announce themselves, and show their
# certificates and permissions, before they have keys. The names of participants include that of the robot.
ANNOUNCEMENT, HANDSHAKE = "000100c2", "000201c3"
TOPIC_DISCOVERY, LIVELINESS = ("000003c2", "000004c2"), ("000200c2",)
DATA, DATA_FRAG, SEC_PREFIX = 0x15, 0x16, 0x31
HEARTBEATS = (0x06, 0x07)
NO_DATA = {(4, socket.IPPROTO_ICMP), (4, socket.IPPROTO_IGMP), (6, socket.IPPROTO_ICMPV6), (6, socket.IPPROTO_HOPOPTS)}
TRANSFORMATIONS = {"00000001": "AES-128-GMAC", "00000002": "AES-128-GCM", "00000003": "AES-256-GMAC",
                   "00000004": "AES-256-GCM"}
WRITER_AT = {DATA: 8, DATA_FRAG: 8, 0x06: 4, 0x07: 4, 0x08: 4, 0x12: 4, 0x13: 4}


def capture(command):
    packets = []
    # Without the link header; 3: ETH_P_ALL, 33: SO_RCVBUFFORCE, 263 and 6: SOL_PACKET and PACKET_STATISTICS.
    listener = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(3))
    listener.setsockopt(socket.SOL_SOCKET, 33, 1 << 29)
    listener.bind(("lo", 0))
    process = subprocess.Popen(command, stdout=sys.stderr)
    running = True
    while running:
        running = process.poll() is None
        # After the command has ended, packets that it sent before are still read.
        while select.select([listener], [], [], 0.1 if running else 0)[0]:
            packet, sender = listener.recvfrom(1 << 17)
            if sender[2] != socket.PACKET_OUTGOING:  # lo shows each packet as it goes and as it comes
                packets.append(packet)
    if process.returncode != 0:
        sys.exit(f"{command[0]} ended with {process.returncode}")
    lost = struct.unpack("II", listener.getsockopt(263, 6, 8))[1]
    if lost:
        sys.exit(f"the capture lost {lost} packets")
    return packets


def messages_of(packets):
    for packet in packets:
        version = packet[0] >> 4
        protocol = packet[9 if version == 4 else 6]
        if (version, protocol) == (4, socket.IPPROTO_UDP):
            yield packet[4 * (packet[0] & 15) + 8 :]
        elif (version, protocol) not in NO_DATA:  # ICMP quotes packets that are already captured
            yield packet


def submessages(message):
    at = 20  # after the RTPS header
    while at + 4 <= len(message):
        kind, flags = message[at], message[at + 1]
        size = struct.unpack_from("<H" if flags & 1 else ">H", message, at + 2)[0]
        end = at + 4 + size if size or kind in (0x01, 0x09) else len(message)  # size 0: the last one, up to the end
        yield kind, message[at:end]
        at = end


def fnv1a(text):
    value = 0xCBF29CE484222325
    for byte in text.encode():
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return value


def ranges_of(log):
    """Four ranges of the first scan that differ from each other, as they are in a message."""
    with open(log) as file:
        words = next(line for line in file if line.startswith("FLASER")).split()
    ranges = words[2 : 2 + int(words[1])]
    return next(
        struct.pack("<4f", *map(float, four)) for four in zip(*(ranges[i:] for i in range(4))) if len(set(four)) == 4
    )


def readable(packets, robot, log):
    found = set()
    messages = list(messages_of(packets))
    rest = []  # without announcements and handshakes
    for message in messages:
        if not message.startswith(b"RTPS"):
            found.add("a packet that is not of RTPS over UDP")
            rest.append(message)
            continue
        for kind, submessage in submessages(message):
            at = WRITER_AT.get(kind)
            writer = None if at is None else submessage[4 + at : 8 + at].hex()
            if kind in (DATA, DATA_FRAG) and writer in (ANNOUNCEMENT, HANDSHAKE):
                continue
            rest.append(submessage)
            if kind == SEC_PREFIX:
                transformation = submessage[4:8].hex()
                found.add(TRANSFORMATIONS.get(transformation, transformation))
            elif writer in TOPIC_DISCOVERY + LIVELINESS:
                # Writers without data also send heartbeats, although others of the same kind are encrypted.
                if kind not in HEARTBEATS:
                    found.add("discovery of topics" if writer in TOPIC_DISCOVERY else "liveliness")
            elif writer is not None:
                found.add("protected built-in topics" if writer.startswith("ff") else "messages of topics")
    everything, rest = b"\0".join(messages), b"\0".join(rest)
    nowhere = {
        "key of the robot": re.escape(struct.pack("<Q", fnv1a(robot))),
        "name of a topic": rb"topogeo/v\d+/\w",
        "name of a type": rb"topogeo::msg::\w",
        "name of a worker": rb"ga_worker_\d",
        "ranges of a scan": re.escape(ranges_of(log)),
    }
    not_in_rest = {"name of the robot": robot, "match_tasks": "match_tasks", "service_status": "service_status"}
    found.update(name for name, text in nowhere.items() if re.search(text, everything))
    found.update(name for name, text in not_in_rest.items() if text.encode() in rest)
    return found


if __name__ == "__main__":
    print("\n".join(sorted(readable(capture(sys.argv[3:]), sys.argv[1], sys.argv[2]))))
