#!/usr/bin/env python3
"""Services that are frozen or killed while a robot drives: which come back, and when.

    tests/bench/drive_faults.py OUT freeze|kill [ROUNDS]        as root, in a network of its own

`topogeo run --sim` with a map and a page; its robot drives to and fro between two points. In each round one service
fails at a random moment of the drive:

    freeze  stopped (SIGSTOP) for 1 to 120 s, then goes on (SIGCONT); 100 rounds take 80 minutes
    kill    killed with -9; 100 rounds take 40 minutes

A line of OUT/FAULT.tsv has for each round the time until `topogeo status` found all services well, the time that the
drive took longer than undisturbed ones (kill), and the duration of the drive back, which no deaf link allows. SEED=n
chooses other rounds; with TOPOGEO_SECURITY all of it runs with keys. Exits with 1 if a service was not well again within
15 s, a killed one delayed the drive by more, or the robot did not arrive.
"""
import json
import os
import pathlib
import random
import signal
import statistics
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("BIN", ROOT / "build/bin"))
WORLD = ROOT / "share/worlds/room.world.yaml"
SERVICES = ["sensor_gateway", "local_mapper", "localizer", "map_store", "planner", "navigator", "web"]
DURATIONS_S = [1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 30, 45, 60, 90, 120]
THERE, BACK = "4.5,1", "1,1"
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


class Drive:
    """A goal on its way."""

    def __init__(self, goal, log):
        self.begin = time.monotonic()
        self.process = subprocess.Popen([BIN / "topogeo", "goto", goal, "--wait-seconds", "30"],
                                        stdout=log, stderr=log)

    def arrives(self):
        """Waits; seconds from the order to the arrival, None: it was given up."""
        try:
            arrived = self.process.wait(timeout=GIVE_UP_S) == 0
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            arrived = False
        return time.monotonic() - self.begin if arrived else None


def process_of(run, service):
    """The child of the run that has the service; None while it starts again."""
    found = subprocess.run(["pgrep", "-P", str(run.pid), "-x", service], capture_output=True, text=True).stdout.split()
    return int(found[0]) if found else None


def text_of(seconds):
    return "-" if seconds is None else f"{seconds:.1f}"


def undisturbed_s(log):
    """The median duration of a drive there."""
    durations = []
    for _ in range(4):
        back_s, there_s = Drive(BACK, log).arrives(), Drive(THERE, log).arrives()
        if back_s is None or there_s is None:
            sys.exit("drive_faults: an undisturbed robot does not arrive")
        durations.append(there_s)
    Drive(BACK, log).arrives()
    return statistics.median(durations)


def freeze_round(process, frozen_s, drive, watch):
    os.kill(process, signal.SIGSTOP)
    time.sleep(frozen_s)  # the fault itself
    os.kill(process, signal.SIGCONT)
    begin = time.monotonic()
    well = watch.wait_for_well(begin + GIVE_UP_S)
    drive.arrives()  # or the order was given up meanwhile, which is right
    return (well - begin if well else None), None


def kill_round(process, usual_s, drive, watch):
    begin = time.monotonic()
    os.kill(process, signal.SIGKILL)
    well = watch.wait_for_well(begin + GIVE_UP_S)
    took_s = drive.arrives()
    return (well - begin if well else None), (took_s - usual_s if took_s else None)


def rounds_of(fault, rounds, run, watch, log, table):
    """Returns how many rounds failed."""
    chosen = random.Random(int(os.environ.get("SEED", "1")))
    # Each duration comes equally often, in a random order.
    durations = [DURATIONS_S[i % len(DURATIONS_S)] for i in range(rounds)]
    chosen.shuffle(durations)
    usual_s = undisturbed_s(log) if fault == "kill" else None
    print("round\tservice\tfrozen_s\twell_after_s\tlost_s\tback_s\trest", file=table, flush=True)
    failed = 0
    for number, frozen_s in enumerate(durations):
        service = SERVICES[number % len(SERVICES)]
        drive = Drive(THERE, log)
        time.sleep(chosen.uniform(0.5, 5.0))  # a random moment of the drive
        process = process_of(run, service)
        if fault == "kill":
            well_s, lost_s = kill_round(process, usual_s, drive, watch)
        else:
            well_s, lost_s = freeze_round(process, frozen_s, drive, watch)
        rest = "" if well_s is not None else watch.states()
        back_s = Drive(BACK, log).arrives()
        late = well_s is None or well_s > LONGEST_AWAY_S
        lost = fault == "kill" and (lost_s is None or lost_s > LONGEST_AWAY_S)
        failed += late or lost or back_s is None
        print(number, service, frozen_s if fault == "freeze" else "-", text_of(well_s), text_of(lost_s),
              text_of(back_s), rest, sep="\t", file=table, flush=True)
    return failed


def main():
    if len(sys.argv) not in (3, 4) or sys.argv[2] not in ("freeze", "kill"):
        sys.exit(__doc__)
    out, fault = pathlib.Path(sys.argv[1]), sys.argv[2]
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 100
    out.mkdir(parents=True, exist_ok=True)
    if not (out / "map/map.pb").exists():
        subprocess.run([BIN / "topogeo", "run", "--sim", WORLD, "--out", out / "map", "--workers", "0"], check=True)
    log = open(out / "log.txt", "w")
    run = subprocess.Popen([BIN / "topogeo", "run", "--sim", WORLD, "--map", out / "map/map.pb", "--web", "--port", "0",
                            "--workers", "0", "--out", out / "run"], stdout=log, stderr=log)
    watch = Watch()
    try:
        if watch.wait_for_well(time.monotonic() + GIVE_UP_S) is None:
            sys.exit(f"drive_faults: the services did not start: {watch.states()}")
        with open(out / f"{fault}.tsv", "w") as table:
            failed = rounds_of(fault, rounds, run, watch, log, table)
    finally:
        watch.process.terminate()
        run.send_signal(signal.SIGINT)
        run.wait()
    print(f"{rounds} rounds, {failed} failed; see {out / (fault + '.tsv')}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
