"""CPU time of each test that ctest runs, sampled from /proc while it runs."""

import os
import threading

PERIOD_S = 0.3
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def read_processes(folder="/proc"):
    """{process: (parent, own seconds, seconds of descendants it has waited for)}."""
    processes = {}
    for name in os.listdir(folder):
        if not name.isdigit():
            continue
        try:
            with open(os.path.join(folder, name, "stat"), encoding="utf-8", errors="replace") as file:
                fields = file.read().rpartition(")")[2].split()
        except OSError:
            continue  # has ended meanwhile
        user, system, waited_user, waited_system = (int(value) / TICKS_PER_S for value in fields[11:15])
        processes[int(name)] = (int(fields[1]), user + system, waited_user + waited_system)
    return processes


def seconds_below(root, processes):
    """{child of root: CPU seconds of it and all its descendants}."""
    children = {}
    for process, (parent, _, _) in processes.items():
        children.setdefault(parent, []).append(process)

    def total(process):
        _, own, waited = processes[process]
        return own + waited + sum(total(child) for child in children.get(process, ()))

    return {child: total(child) for child in children.get(root, ())}


def command_of(process, folder="/proc"):
    try:
        with open(os.path.join(folder, str(process), "cmdline"), "rb") as file:
            return tuple(file.read().decode(errors="replace").rstrip("\0").split("\0"))
    except OSError:
        return ()


class Sampler:
    """Samples the children of a ctest until stop(). What a test uses after its last sample is not counted, nor what
    processes use that outlive it or belong to a container engine."""

    def __init__(self, listing):
        self._names = {tuple(test["command"]): test["name"] for test in listing["tests"] if test.get("command")}
        self._tests = {}  # names by process
        self._end = threading.Event()
        self._thread = None
        self.seconds = {}

    def start(self, ctest):
        self._thread = threading.Thread(target=self._run, args=(ctest,), daemon=True)
        self._thread.start()

    def stop(self):
        self._end.set()
        self._thread.join()

    def _run(self, ctest):
        while not self._end.wait(PERIOD_S):
            self.take(ctest, read_processes(), command_of)

    def take(self, ctest, processes, command):
        """Adds a sample. A child that has not yet become its test is left to the next sample."""
        found = seconds_below(ctest, processes)
        for process in set(self._tests) - set(found):
            del self._tests[process]
        for process, seconds in found.items():
            name = self._tests.get(process) or self._names.get(command(process))
            if name:
                self._tests[process] = name
                self.seconds[name] = max(self.seconds.get(name, 0.0), seconds)
