#!/usr/bin/env python3
"""Measures what a simulated robot costs that stands, with the page's service and no page open, as a Markdown table: CPU
time, context switches and memory of each program, and packets of all. As root it runs in a network of its own.

    tests/bench/standing_robot.py [--bin build/bin] [--world share/worlds/rooms.world.yaml] [--warm-up 15] [--seconds 30]
"""
import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time

TICKS = os.sysconf("SC_CLK_TCK")
PAGE_bytes = os.sysconf("SC_PAGE_SIZE")


def own_network():
    """Starts this script again in namespaces of its own, so that no other program sends there."""
    script = ("mount -t tmpfs tmpfs /dev/shm; ip link set lo up multicast on; ip route add 224.0.0.0/4 dev lo; "
              'exec "$0" "$@"')
    os.execvp("unshare", ["unshare", "-n", "-m", "--propagation", "private", "sh", "-c", script, *sys.argv, "--inside"])


def children(parent):
    with open(f"/proc/{parent}/task/{parent}/children", encoding="ascii") as file:
        return [int(pid) for pid in file.read().split()]


def sample(pids):
    """(CPU time in s, context switches, memory in bytes) of each process."""
    found = {}
    for pid in pids:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        switches = 0
        for thread in os.listdir(f"/proc/{pid}/task"):
            with open(f"/proc/{pid}/task/{thread}/status", encoding="utf-8") as file:
                switches += sum(int(line.split()[1]) for line in file if "ctxt_switches" in line)
        with open(f"/proc/{pid}/statm", encoding="ascii") as file:
            memory = int(file.read().split()[1]) * PAGE_bytes
        found[pid] = ((int(fields[11]) + int(fields[12])) / TICKS, switches, memory)
    return found


def datagrams():
    """UDP packets that this network has sent."""
    with open("/proc/net/snmp", encoding="ascii") as file:
        names, values = [line.split() for line in file if line.startswith("Udp:")]
    return int(values[names.index("OutDatagrams")])


def table(names, before, after, packets, seconds):
    rows = sorted(((names[pid], (after[pid][0] - before[pid][0]) / seconds * 100, (after[pid][1] - before[pid][1]) / seconds,
                    after[pid][2] / 1e6) for pid in names), key=lambda row: -row[1])
    yield "| program | CPU, % of a core | context switches/s | memory, MB |"
    yield "|---|---|---|---|"
    for name, cpu, switches, memory in rows:
        yield f"| {name} | {cpu:.1f} | {switches:.0f} | {memory:.0f} |"
    services = [row for row in rows if row[0] not in ("simulator", "topogeo")]
    yield (f"| services without simulator and supervisor | {sum(row[1] for row in services):.1f} | "
           f"{sum(row[2] for row in services):.0f} | {sum(row[3] for row in services):.0f} |")
    yield ""
    yield f"{packets / seconds:.0f} packets a second"


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    project = os.path.dirname(os.path.dirname(here))
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--bin", default=f"{project}/build/bin")
    parser.add_argument("--world", default=f"{project}/share/worlds/rooms.world.yaml")
    parser.add_argument("--warm-up", type=float, default=15.0, metavar="SECONDS")
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if os.getuid() == 0 and not options.inside:
        own_network()
    with tempfile.TemporaryDirectory() as folder:
        command = [f"{options.bin}/topogeo", "run", "--sim", options.world, "--web", "--port", "0", "--out", f"{folder}/out"]
        with open(f"{folder}/log", "wb") as log, subprocess.Popen(command, stdout=log, stderr=log) as run:
            try:
                time.sleep(options.warm_up)  # nothing tells that all have met and the map is made
                pids = [run.pid, *children(run.pid)]
                names = {pid: os.path.basename(os.readlink(f"/proc/{pid}/exe")) for pid in pids}
                before, sent = sample(pids), datagrams()
                time.sleep(options.seconds)  # the time over which it measures
                for line in table(names, before, sample(pids), datagrams() - sent, options.seconds):
                    print(line)
            finally:
                run.send_signal(signal.SIGINT)


if __name__ == "__main__":
    main()
