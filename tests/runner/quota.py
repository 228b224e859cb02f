"""A slow machine on demand: a part of the CPU for a command, or busy neighbours beside it.

The quota is a control group with a period of 10 ms, so that it is like a slow core and not like one that stops for a
tenth of a second. Where no group can be made, loops of higher priority take what is to be taken.
"""

import ctypes
import os
import shutil
import signal
import subprocess
import sys
import time

PERIOD_US = 10000
LEAST_CPUS = 0.1  # the kernel takes no quota below a millisecond


def as_root():
    """What stands before a command that needs root; None where there is no way to be root."""
    if os.geteuid() == 0:
        return []
    if not shutil.which("sudo"):
        return None
    if subprocess.run(["sudo", "-n", "true"], capture_output=True, check=False).returncode == 0 or sys.stdin.isatty():
        return ["sudo"]
    return None


def parent_groups(mounts, own, version):
    """Folders below which a group may be made, best first: that of this process, then the root of the hierarchy.

    `mounts` is the text of /proc/self/mounts, `own` that of /proc/self/cgroup.
    """
    for line in mounts.splitlines():
        _, point, kind, options = line.split()[:4]
        if version == 1 and (kind != "cgroup" or "cpu" not in options.split(",")):
            continue
        if version == 2 and kind != "cgroup2":
            continue
        path = ""
        for entry in own.splitlines():
            number, controllers, group = entry.split(":", 2)
            if (version == 1 and "cpu" in controllers.split(",")) or (version == 2 and number == "0"):
                path = group
        return list(dict.fromkeys([(point + path).rstrip("/"), point]))
    return []


def quota_commands(group, cpus, version):
    """Lines of shell that make a group of that quota."""
    quota = round(cpus * PERIOD_US)
    if version == 1:
        return [f"mkdir '{group}'", f"echo {PERIOD_US} > '{group}/cpu.cfs_period_us'",
                f"echo {quota} > '{group}/cpu.cfs_quota_us'"]
    parent = os.path.dirname(group)
    return [f"grep -qw cpu '{parent}/cgroup.subtree_control' || echo +cpu > '{parent}/cgroup.subtree_control'",
            f"mkdir '{group}'", f"echo '{quota} {PERIOD_US}' > '{group}/cpu.max'"]


class Group:
    """A control group. Use as a context; `group.join` is for preexec_fn."""

    def __init__(self, folder, parent, root):
        self.folder = folder
        self._parent = parent
        self._root = root

    @staticmethod
    def make(cpus):
        """None where the machine lets us make none."""
        root = as_root()
        if root is None:
            return None
        with open("/proc/self/mounts", encoding="utf-8") as mounts, open("/proc/self/cgroup", encoding="utf-8") as own:
            mounts, own = mounts.read(), own.read()
        for version in (1, 2):
            for parent in parent_groups(mounts, own, version):
                group = f"{parent}/topogeo_tests_{os.getpid()}"
                script = " && ".join(f"{{ {line}; }}" for line in quota_commands(group, cpus, version))
                made = subprocess.run(root + ["sh", "-c", script], capture_output=True, check=False)
                if made.returncode == 0:
                    return Group(group, parent, root)
                subprocess.run(root + ["rmdir", group], capture_output=True, check=False)
        return None

    def join(self):
        """The calling process, with all that it starts."""
        self._move(os.getpid(), self.folder)

    def processes(self):
        try:
            with open(f"{self.folder}/cgroup.procs", encoding="utf-8") as file:
                return [int(line) for line in file]
        except OSError:
            return []

    def _move(self, process, folder):
        return subprocess.run(self._root + ["sh", "-c", f"echo {process} > '{folder}/cgroup.procs'"],
                              capture_output=True, check=False).returncode == 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        end = time.monotonic() + 10
        while self.processes() and time.monotonic() < end:
            time.sleep(0.1)  # between two checks
        # Processes that outlive the tests must not stay slow.
        for process in self.processes():
            self._move(process, self._parent)
        removed = subprocess.run(self._root + ["rmdir", self.folder], capture_output=True, text=True, check=False)
        if removed.returncode != 0:
            print(f"run: test: the control group stays: {removed.stderr.strip()}", file=sys.stderr)


class Loops:
    """Processes that use the CPU. They end with this process, however that ends."""

    def __init__(self):
        self._pids = []

    def add(self, busy_share=1.0, core=None, niceness=0):
        pid = os.fork()
        if pid == 0:
            _loop(busy_share, core, niceness)
        self._pids.append(pid)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for pid in self._pids:
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)


def _loop(busy_share, core, niceness):
    """Busy for that share of each period, never returns."""
    parent_death_signal = 1
    ctypes.CDLL(None).prctl(parent_death_signal, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles it
    if core is not None:
        os.sched_setaffinity(0, [core])
    try:
        os.setpriority(os.PRIO_PROCESS, 0, niceness)
    except PermissionError:
        pass
    period = PERIOD_US * 1e-6
    while True:
        start = time.monotonic()
        while time.monotonic() < start + busy_share * period:
            pass
        if busy_share < 1.0:
            # The rest of the period is left to other processes.
            time.sleep(max(0.0, start + period - time.monotonic()))


def take_all_but(cpus, loops):
    """Without a control group: on each core a loop that leaves its share of `cpus`, more or less. The command must be
    started with be_nice, so that a loop goes first."""
    cores = sorted(os.sched_getaffinity(0))
    for core in cores:
        loops.add(busy_share=max(0.0, 1.0 - cpus / len(cores)), core=core, niceness=-20)


def be_nice():
    os.setpriority(os.PRIO_PROCESS, 0, 15)  # has a thirtieth of a loop's weight
