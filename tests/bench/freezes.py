#!/usr/bin/env python3
"""Services that are frozen while a robot drives: which come back, and when.

    tests/bench/freezes.py OUT [ROUNDS]        100 rounds take about an hour; as root, in a network of its own

`topogeo run --sim` with a map and a page; its robot drives to and fro between two points. In each round one service is
stopped (SIGSTOP) at a random moment for 1 to 120 s, then goes on (SIGCONT). A table in OUT/freezes.tsv has for each round
how long it took until `topogeo status` found all services well, and how long until the robot arrived at its next goal,
which no link that stayed deaf lets it. SEED=n chooses other rounds; with TOPOGEO_SECURITY all of it runs with keys.
Exits with 1 if a service was not well again within 15 s of a machine with time, or the robot did not arrive.
"""
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("BIN", ROOT / "build/bin"))
WORLD = ROOT / "tests/data/room.world.yaml"
SERVICES = ["sensor_gateway", "local_mapper", "localizer", "map_store", "planner", "navigator", "web"]
DURATIONS_S = [1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 30, 45, 60, 90, 120]
GOALS = ["4.5,1", "1,1"]
LONGEST_AWAY_S = 15.0
GIVE_UP_S = 120.0


class Watch:
    """`topogeo status --watch --json`, whose newest table is at hand."""

    def __init__(self):
        self.process = subprocess.Popen([BIN / "topogeo", "status", "--watch", "--json"], stdout=subprocess.PIPE, text=True)
        self.table, self.count = [], 0
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        text = ""
        for line in self.process.stdout:
            text += line
            if line.startswith("]"):  # a table is an array over many lines
                self.table, self.count, text = json.loads(text), self.count + 1, ""

    def wait_for_well(self, deadline):
        """Until two tables in a row have every service running and none silent, lost or deaf; None: it took too long."""
        well, seen = 0, self.count
        while time.monotonic() < deadline:
            if self.count == seen:
                time.sleep(0.05)  # between two checks
                continue
            seen = self.count
            states = {row["service"]: row["state"] for row in self.table}
            well = well + 1 if all(states.get(name) == "running" for name in SERVICES) else 0
            if well == 2:
                return time.monotonic()
        return None

    def states(self):
        return " ".join(f'{row["service"]}={row["state"]}' for row in self.table if row["state"] != "running")


def goto(goal, out):
    return subprocess.Popen([BIN / "topogeo", "goto", goal, "--wait-seconds", "30"], stdout=out, stderr=out)


def process_of(run, service):
    """The child of the run that has the service; None while it starts again."""
    found = subprocess.run(["pgrep", "-P", str(run.pid), "-x", service], capture_output=True, text=True).stdout.split()
    return int(found[0]) if found else None


def main():
    out = pathlib.Path(sys.argv[1])
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 100
    out.mkdir(parents=True, exist_ok=True)
    chosen = random.Random(int(os.environ.get("SEED", "1")))
    if not (out / "map/map.pb").exists():
        subprocess.run([BIN / "topogeo", "run", "--sim", WORLD, "--out", out / "map", "--workers", "0"], check=True)
    log = open(out / "log.txt", "w")
    run = subprocess.Popen([BIN / "topogeo", "run", "--sim", WORLD, "--map", out / "map/map.pb", "--web", "--port", "0",
                            "--workers", "0", "--out", out / "run"], stdout=log, stderr=log)
    watch, failed = Watch(), 0
    try:
        if watch.wait_for_well(time.monotonic() + GIVE_UP_S) is None:
            sys.exit(f"freezes: the services did not start: {watch.states()}")
        table = open(out / "freezes.tsv", "w")
        print("round\tservice\tfrozen_s\twell_after_s\tdriven_after_s\trest", file=table, flush=True)
        # Each duration comes equally often, in a random order.
        durations = [DURATIONS_S[i % len(DURATIONS_S)] for i in range(rounds)]
        chosen.shuffle(durations)
        for number, frozen_s in enumerate(durations):
            service = SERVICES[number % len(SERVICES)]
            driving = goto(GOALS[number % 2], log)
            time.sleep(chosen.uniform(0.5, 5.0))  # a random moment of the drive
            process = process_of(run, service)
            os.kill(process, signal.SIGSTOP)
            time.sleep(frozen_s)  # the fault itself
            os.kill(process, signal.SIGCONT)
            begin = time.monotonic()
            well = watch.wait_for_well(begin + GIVE_UP_S)
            rest = "" if well else watch.states()
            # The order of before may have been given up meanwhile, which is right.
            try:
                driving.wait(timeout=GIVE_UP_S)
            except subprocess.TimeoutExpired:
                driving.kill()
            after = time.monotonic()
            arrived = goto(GOALS[(number + 1) % 2], log).wait() == 0
            driven_s = time.monotonic() - after
            well_s = well - begin if well else GIVE_UP_S
            failed += not arrived or well_s > LONGEST_AWAY_S
            print(f"{number}\t{service}\t{frozen_s}\t{well_s:.1f}\t{f'{driven_s:.1f}' if arrived else '-'}\t{rest}",
                  file=table, flush=True)
    finally:
        watch.process.terminate()
        run.send_signal(signal.SIGINT)
        run.wait()
    print(f"{rounds} rounds, {failed} failed; see {out / 'freezes.tsv'}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
