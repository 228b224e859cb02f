"""CPU time that each test of a ctest wants, sampled from /proc while it runs: what it gets, and what its threads wait
for a CPU that others have."""

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


def read_queues(process, folder="/proc"):
    """Seconds that the living threads of a process have run and that they have waited for a CPU."""
    run, waited = 0, 0
    tasks = os.path.join(folder, str(process), "task")
    try:
        for task in os.listdir(tasks):
            with open(os.path.join(tasks, task, "schedstat"), encoding="utf-8") as file:
                fields = file.read().split()
            run += int(fields[0])
            waited += int(fields[1])
    except OSError:
        pass  # the process or a thread has ended meanwhile
    return 1e-9 * run, 1e-9 * waited


def below(root, processes):
    """{child of root: it and all its descendants}."""
    children = {}
    for process, (parent, _, _) in processes.items():
        children.setdefault(parent, []).append(process)

    def tree(process):
        found = [process]
        for child in children.get(process, ()):
            found += tree(child)
        return found

    return {child: tree(child) for child in children.get(root, ())}


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
        self._queues = {}  # by name: seconds that threads have run and waited, when most were there
        self._end = threading.Event()
        self._thread = None
        self._seconds = {}

    def start(self, ctest):
        self._thread = threading.Thread(target=self._run, args=(ctest,), daemon=True)
        self._thread.start()

    def stop(self):
        self._end.set()
        self._thread.join()

    def wanted_s(self):
        """{test: CPU seconds that it would have had with enough CPUs in the time that it took}."""
        return {name: seconds * self._queue_factor(name) for name, seconds in self._seconds.items()}

    def _queue_factor(self, name):
        run, waited = self._queues[name]
        return 1.0 + waited / run if run > 0.0 else 1.0

    def _run(self, ctest):
        while not self._end.wait(PERIOD_S):
            self.take(ctest, read_processes(), command_of, read_queues)

    def take(self, ctest, processes, command, queues):
        """Adds a sample. A child that has not yet become its test is left to the next sample."""
        found = below(ctest, processes)
        for process in set(self._tests) - set(found):
            del self._tests[process]
        for process, tree in found.items():
            name = self._tests.get(process) or self._names.get(command(process))
            if not name:
                continue
            self._tests[process] = name
            seconds = sum(processes[member][1] + processes[member][2] for member in tree)
            self._seconds[name] = max(self._seconds.get(name, 0.0), seconds)
            times = [queues(member) for member in tree]
            queue = (sum(run for run, _ in times), sum(waited for _, waited in times))
            self._queues[name] = max(self._queues.get(name, (0.0, 0.0)), queue)
