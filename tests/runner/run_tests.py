#!/usr/bin/env python3
"""Runs ctest as people need it, and says at the end what came of it. `./run test` starts it when all is built."""

import argparse
import contextlib
import json
import math
import os
import signal
import subprocess
import sys
import time

import changed
import costs
import quota
import summary

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))

HELP = """usage: ./run test [OPTIONS] [NAME...] [CTEST OPTIONS]

Runs all tests, or those whose name matches one of the regular expressions NAME.

  --changed [COMMIT]   those that the difference to COMMIT (default HEAD; what is not committed or added included)
                       can reach
  --cpus N             with the CPU time of N cores (e.g. 0.8) for all tests together: a slow machine. By a control
                       group, which root or sudo must be able to make, else by busy loops of higher priority that
                       leave about N. Containers belong to their engine and are outside, unless the tests start it
  --beside N           beside N busy loops
  --repeat N           N times, whatever comes out; says how many were green
  --time-tests quick|all
                       those that once failed because a machine was slow (tests/runner/time_tests.txt)
  --save-costs         writes what each test took into tests/costs.txt, by which ctest orders them
  --sanitize address|thread [--short]
                       with a sanitizer compiled in, in build-asan or build-tsan; --short: what has threads and
                       parsers, two minutes. Must be first
  -h, --help           this text

Options of ctest are passed on, for example -L browser (by label; `ctest --test-dir build --print-labels`), -j 1, -V.
What failed tests leave behind, logs of services included, is in build/tests/failed/.
"""

# Options of ctest whose value is the next word.
WITH_VALUE = {
    "-R", "--tests-regex", "-E", "--exclude-regex", "-L", "--label-regex", "-LE", "--label-exclude", "-I",
    "--tests-information", "-FA", "--fixture-exclude-any", "-FS", "--fixture-exclude-setup", "-FC",
    "--fixture-exclude-cleanup", "--timeout", "--stop-time", "--resource-spec-file", "--test-load", "-j",
    "--parallel", "-O", "--output-log", "--output-junit", "--test-output-size-passed", "--test-output-size-failed",
    "--test-output-truncation", "-C", "--build-config"}
# These print a list and run no test.
LISTING = {"-N", "--print-labels", "--show-only", "--help-full"}


def say(text):
    print(f"run: test: {text}", file=sys.stderr, flush=True)


def number(text, name, least, whole=False):
    try:
        value = int(text) if whole else float(text)
    except ValueError:
        value = -1
    if not least <= value < 1000:
        raise ValueError(f"{name} takes a {'whole ' if whole else ''}number from {least}, got '{text}'")
    return value


def parse(words):
    """Our options, names and ctest's options of a command line. Throws ValueError."""
    options = argparse.Namespace(changed=None, cpus=None, beside=0, repeat=1, save_costs=False, time_tests=None, again="./run test",
                                 build=os.path.join(ROOT, "build"), preset=None, check=False, names=[], ctest=[])
    words = list(words)

    def value(name):
        if not words:
            raise ValueError(f"{name} needs a value")
        return words.pop(0)

    while words:
        word = words.pop(0)
        name, equals, inline = word.partition("=")
        if equals and name in ("--cpus", "--beside", "--repeat", "--changed", "--time-tests"):
            words.insert(0, inline)
            word = name
        if word == "--changed":
            options.changed = words.pop(0) if words and not words[0].startswith("-") else "HEAD"
        elif word == "--cpus":
            options.cpus = number(value(word), word, quota.LEAST_CPUS)
        elif word == "--beside":
            options.beside = number(value(word), word, 0, whole=True)
        elif word == "--repeat" and words and words[0].lstrip("-").isdigit():
            options.repeat = number(value(word), word, 1, whole=True)
        elif word == "--time-tests":
            options.time_tests = value(word)
            if options.time_tests not in ("quick", "all"):
                raise ValueError(f"--time-tests takes quick or all, got '{options.time_tests}'")
        elif word == "--sanitize":
            raise ValueError("--sanitize must be the first option")
        elif word == "--save-costs":
            options.save_costs = True
        elif word in ("--build", "--preset", "--again"):  # of ./run alone
            setattr(options, word[2:], value(word))
        elif word == "--check":
            options.check = True
        elif word.startswith("-"):
            options.ctest.append(word)
            if word in WITH_VALUE or word == "--repeat":
                options.ctest.append(value(word))
        else:
            options.names.append(word)
    return options


def time_tests(which):
    """Regular expressions of the tests that once depended on time."""
    with open(os.path.join(ROOT, "tests", "runner", "time_tests.txt"), encoding="utf-8") as file:
        lines = [line.split() for line in file if line.strip() and not line.startswith("#")]
    return [pattern for speed, pattern in lines if which == "all" or speed == which]


def jobs(cpus):
    """Three for each core: many tests wait for devices, containers and services most of their time."""
    return 3 * (os.cpu_count() if cpus is None else min(os.cpu_count(), math.ceil(cpus)))


class Runner:
    def __init__(self, options):
        self._options = options
        self._preset = ["--preset", options.preset] if options.preset else ["--test-dir", options.build]
        self._failed_folder = os.path.join(options.build, "tests", "failed")
        self._junit = os.path.join(options.build, "Testing", "junit.xml")
        self._log = os.path.join(options.build, "Testing", "output.log")
        self._join = None

    def _listing(self):
        command = ["ctest", *self._preset, "--show-only=json-v1"]
        return json.loads(subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout)

    def _selection(self):
        """Arguments of ctest that choose the tests; None: there is nothing to run."""
        patterns = list(self._options.names)
        if self._options.time_tests:
            patterns += time_tests(self._options.time_tests)
        if self._options.changed is not None:
            tests = self._listing()["tests"]
            files, names = changed.find(ROOT, self._options.build, self._options.changed, tests)
            say(f"{len(files)} files differ from {self._options.changed}, {len(names)} of {len(tests)} tests can notice")
            if not names:
                return None
            patterns += changed.patterns_of(names, tests)
        return ["-R", "|".join(f"({pattern})" for pattern in patterns)] if patterns else []

    def _command(self, selection):
        # Prints the output of all tests, because passed ones may have skipped parts with a reason.
        command = ["ctest", *self._preset, f"-j{jobs(self._options.cpus)}", "--output-on-failure", "--no-tests=error",
                   "--output-junit", self._junit, "--output-log", self._log,
                   "--test-output-size-passed", "1000000", "--test-output-size-failed", "4000000"]
        return command + selection + self._options.ctest

    def _again(self):
        words = [self._options.again]
        if self._options.cpus is not None:
            words.append(f"--cpus {self._options.cpus:g}")
        if self._options.beside:
            words.append(f"--beside {self._options.beside}")
        return " ".join(words)

    def _limits(self, stack):
        """Starts neighbours, makes the quota."""
        loops = stack.enter_context(quota.Loops())
        for _ in range(self._options.beside):
            loops.add()
        if self._options.beside:
            say(f"beside {self._options.beside} busy loops")
        cpus = self._options.cpus
        if cpus is None:
            return
        if cpus >= len(os.sched_getaffinity(0)):
            say(f"this machine has {len(os.sched_getaffinity(0))} cores, a quota of {cpus:g} holds back nothing")
            return
        group = quota.Group.make(cpus)
        if group:
            self._join = stack.enter_context(group).join
            say(f"a quota of {cpus:g} cores, by the control group {group.folder}")
        else:
            quota.take_all_but(cpus, loops)
            self._join = quota.be_nice
            say(f"no control group can be made here: busy loops leave about {cpus:g} cores")

    def _once(self, command):
        """Runs ctest. Returns its status and closing line."""
        for path in (self._junit, self._log):
            with contextlib.suppress(FileNotFoundError):
                os.remove(path)
        os.makedirs(os.path.dirname(self._junit), exist_ok=True)
        # A process group of its own, so that stopping this program alone can stop all tests.
        with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL, preexec_fn=self._join,
                              process_group=0) as ctest:
            try:
                status = ctest.wait()
            except BaseException:
                end_all(ctest)
                raise
        if not os.path.exists(self._junit):
            return status or 1, ""
        tests = summary.read_junit(self._junit)
        folders = summary.keep_output(tests, self._failed_folder)
        stages = summary.read_packages(os.path.join(ROOT, "deploy", "packages.txt"))
        print("\n" + "\n".join(summary.summary_lines(tests, folders, stages, self._again(), ROOT)))
        if self._options.save_costs:
            path = os.path.join(ROOT, "tests", "costs.txt")
            print(f"costs of {costs.save_costs(path, tests, self._listing())} tests are in tests/costs.txt")
        with open(self._log, encoding="utf-8", errors="replace") as file:
            return status, summary.closing_line(file.read())

    def run(self):
        selection = self._selection()
        if selection is None:
            return 0
        command = self._command(selection)
        if LISTING & set(word.partition("=")[0] for word in self._options.ctest):
            return subprocess.run(["ctest", *self._preset, *selection, *self._options.ctest], cwd=ROOT,
                                  check=False).returncode
        summary.clear(self._failed_folder)
        green = 0
        verdict = (0, "")
        with contextlib.ExitStack() as stack:
            self._limits(stack)
            for i in range(self._options.repeat):
                if self._options.repeat > 1:
                    print(f"\nrun {i + 1} of {self._options.repeat}", flush=True)
                status, closing = self._once(command)
                green += status == 0
                if status != 0 or verdict[0] == 0:
                    verdict = (status, closing)
                sys.stdout.flush()
        if self._options.repeat > 1:
            print(f"\n{green} of {self._options.repeat} runs were green")
        if verdict[1]:
            print("\n" + verdict[1], flush=True)
        return verdict[0]


def end_all(leader):
    """Ends all processes of the group that `leader` has started, by force those that do not end by themselves."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(leader.pid, signal.SIGINT)
        end = time.monotonic() + 10
        while time.monotonic() < end:
            leader.poll()
            os.killpg(leader.pid, 0)
            time.sleep(0.05)  # between two checks
        os.killpg(leader.pid, signal.SIGKILL)
    leader.wait()


def stop(signal_number, _):
    raise KeyboardInterrupt(signal_number)


def main(words):
    if "-h" in words or "--help" in words:
        print(HELP, end="")
        return 0
    try:
        options = parse(words)
        if options.check:
            return 0
        signal.signal(signal.SIGTERM, stop)
        signal.signal(signal.SIGHUP, stop)
        return Runner(options).run()
    except ValueError as error:
        say(error)
        return 2
    except KeyboardInterrupt:
        say("stopped")
        return 130


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
