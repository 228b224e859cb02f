#!/usr/bin/env python3
"""Follows the map of a robot by the protocol of its web service (docs/web_protocol.md), with the standard library:
follow_map.py [HOST:PORT [once]] prints a line whenever the map has changed."""
import base64
import json
import os
import socket
import sys
import time


def send(connection, opcode, payload):
    mask = os.urandom(4)  # a client masks its frames (RFC 6455, 5.3); this one sends 125 bytes at most
    masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload))
    connection.sendall(bytes([0x80 | opcode, 0x80 | len(payload)]) + mask + masked)


def messages(host, port):
    # Channel `time` has a message every second: after 5 s of silence the connection is dead.
    with socket.create_connection((host, port), timeout=5) as connection, connection.makefile("rb") as stream:
        key = base64.b64encode(os.urandom(16)).decode()
        connection.sendall(f"GET /ws HTTP/1.1\r\nHost: {host}:{port}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                           f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n\r\n".encode())
        head = list(iter(lambda: stream.readline().strip(), b""))
        if not head or b" 101 " not in head[0]:
            raise ConnectionError(f"expected status 101, got {head[:1]}")
        send(connection, 1, b'{"op":"hello","channels":["graph","time"]}')
        text = b""
        while header := stream.read(2):
            size = header[1] if header[1] < 126 else int.from_bytes(stream.read(2 if header[1] == 126 else 8), "big")
            payload, opcode = stream.read(size), header[0] & 0x0F
            if opcode == 9:  # a ping wants a pong
                send(connection, 10, payload)
            text += payload if opcode < 2 else b""
            if opcode < 2 and header[0] & 0x80:  # the last frame of a text
                yield json.loads(text)
                text = b""


def maps(host, port):
    elements, version = {}, 0  # nodes "n12", branches "b7", and the summary "map"
    for message in messages(host, port):
        if message.get("channel") == "graph":
            if message["from"] not in (0, version):
                raise ConnectionError("a change is missing")  # a new connection begins with the whole map
            kept = {key: value for key, value in elements.items() if message["from"] and key not in message["gone"]}
            elements, version = {**kept, **message["set"]}, message["version"]
            yield elements


server, once = (sys.argv[1:] + ["127.0.0.1:8080"])[0].rsplit(":", 1), sys.argv[2:] == ["once"]
while True:
    try:
        for summary in (elements["map"] for elements in maps(server[0], int(server[1]))):
            print(f"version {summary['version']}: {summary['nodes']} nodes, {summary['branches']} branches", flush=True)
            if once:
                sys.exit()
    except (OSError, ValueError) as error:
        print(f"connecting again: {error}", file=sys.stderr)
    time.sleep(1)  # between two connections
