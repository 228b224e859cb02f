"""What a run of ctest came to, for people: read from its JUnit file, printed after all that ctest prints."""

import glob
import os
import re
import shlex
import shutil
import tempfile
import xml.etree.ElementTree as xml
from dataclasses import dataclass, field


@dataclass
class Test:
    name: str
    seconds: float
    state: str  # passed, failed, skipped
    output: str
    reasons: list = field(default_factory=list)  # why it, or a part of it, was skipped


def read_junit(path):
    """All tests of a file that `ctest --output-junit` wrote."""
    tests = []
    for case in xml.parse(path).getroot().iter("testcase"):
        # Another test starts it as a separate program.
        if case.get("status") == "disabled":
            continue
        output = case.findtext("system-out") or ""
        skipped = case.find("skipped")
        state = {"run": "passed", "fail": "failed"}.get(case.get("status"), "failed")
        # "notrun" also stands for a missing program, which is a failure.
        if skipped is not None and skipped.get("message", "").startswith("SKIP_"):
            state = "skipped"
        reasons = skip_reasons(output)
        if state == "skipped" and not reasons:
            reasons = ["it does not say why"]
        tests.append(Test(case.get("name"), float(case.get("time", 0)), state, output, reasons))
    return tests


def skip_reasons(output):
    """Of a script "skipped: REASON", or "PROGRAM is not installed: WHAT" for a part; of GoogleTest the line after
    "FILE:LINE: Skipped"."""
    lines = output.splitlines()
    reasons = []
    for line, following in zip(lines, lines[1:] + [""]):
        if line.startswith("skipped: "):
            reasons.append(line.removeprefix("skipped: ").strip())
        elif re.match(r"\S+ is not installed: ", line):
            reasons.append(line.strip())
        elif re.match(r"\S+:\d+: Skipped$", line):
            reasons.append(following.strip() or "it does not say why")
    return list(dict.fromkeys(reasons))


def read_packages(path):
    """Stage of each package in deploy/packages.txt; the first that has it."""
    stages = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            found = re.match(r"(\w+)(?:@\d+)?: (.*)", line)
            for package in found[2].split() if found else []:
                stages.setdefault(package, found[1])
    return stages


# Programs and Python modules whose package has another name.
PACKAGE_OF = {
    "docker": "docker.io", "dpkg-shlibdeps": "dpkg-dev", "fastdds": "fastdds-tools", "ip": "iproute2", "node": "nodejs",
    "nsenter": "util-linux", "promtool": "prometheus", "rosbag": "python3-rosbag", "setpriv": "util-linux",
    "systemd-analyze": "systemd", "tsc": "node-typescript", "unshare": "util-linux", "wg": "wireguard-tools"}
# In no stage, because nearly every machine has them.
ELSEWHERE = {"curl", "prometheus", "util-linux"}
SUDO = "" if os.geteuid() == 0 else "sudo "


def cure(reason, stages):
    """The command that installs what a skipped test needs; empty where none is known."""
    if "container engine" in reason or reason.startswith("docker"):
        return SUDO + "tests/container/start_engine"
    missing = re.match(r"(\S+) is not installed", reason)
    if not missing:
        return ""
    package = PACKAGE_OF.get(missing[1], missing[1])
    if package in ("nodejs", "npm", "chromium-headless-shell"):
        return "tests/browser/install"
    if package in stages:
        return f"./run packages --install {stages[package]}"
    return f"{SUDO}apt-get install {package}" if package in ELSEWHERE else ""


def folder_name(test):
    """As tests name the folder that they keep."""
    return re.sub(r"[^A-Za-z0-9_.+-]", "_", test)


def pattern(test):
    """A regular expression of CMake that matches this test alone."""
    return "^" + re.sub(r"([\\()\[\]*+?|^$])", r"\\\1", test) + "$"


def keep_output(tests, failed_folder):
    """The output of each failed test beside the files that it kept. Returns the folder of each."""
    folders = {}
    for test in tests:
        if test.state != "failed":
            continue
        folder = os.path.join(failed_folder, folder_name(test.name))
        os.makedirs(folder, exist_ok=True)
        take_scratch(test.name, folder)
        number = 1
        while os.path.exists(path := os.path.join(folder, "output.txt" if number == 1 else f"output_{number}.txt")):
            number += 1
        with open(path, "w", encoding="utf-8") as file:
            file.write(test.output)
        folders[test.name] = [folder] + [kept for kept in re.findall(r"^kept: (\S+)", test.output, re.MULTILINE)
                                         if not (kept + "/").startswith(folder + "/")]
    return folders


def take_scratch(test, folder):
    """Of a program that was killed, at its time limit for example: the files that tests/integration/program.cpp
    could not keep or remove."""
    _, _, case = test.partition(".")
    for path in glob.glob(os.path.join(tempfile.gettempdir(), f"topogeo_{glob.escape(case.replace('/', '_'))}_[0-9]*")):
        shutil.copytree(path, os.path.join(folder, os.path.basename(path)), dirs_exist_ok=True,
                        ignore_dangling_symlinks=True, ignore=not_plain)
        shutil.rmtree(path, ignore_errors=True)


def not_plain(folder, names):
    """Sockets and pipes, which cannot be copied."""
    return [name for name in names
            if not os.path.isfile(path := os.path.join(folder, name)) and not os.path.isdir(path)]


def names_in_line(names, most=6):
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def summary_lines(tests, folders, stages, again="./run test", root="."):
    """The lines to print. `again` is the command that ran these tests."""
    passed = [test for test in tests if test.state == "passed"]
    failed = [test for test in tests if test.state == "failed"]
    skipped = [test for test in tests if test.state == "skipped"]
    lines = [f"{len(passed)} passed, {len(failed)} failed, {len(skipped)} skipped"]
    for test in failed:
        lines += [f"failed: {test.name} (after {test.seconds:.0f} s)",
                  f"  again: {again} {shlex.quote(pattern(test.name))}"]
        lines += [f"  files: {os.path.relpath(folder, root) if folder.startswith(root) else folder}"
                  for folder in folders.get(test.name, [])]
    reasons = {}
    for test in tests:
        for reason in test.reasons if test.state != "failed" else []:
            whole = test.state == "skipped"
            reasons.setdefault(reason, []).append(test.name if whole else f"a part of {test.name}")
    for reason, names in sorted(reasons.items(), key=lambda entry: -len(entry[1])):
        command = cure(reason, stages)
        lines.append(f"skipped: {names_in_line(names)}: {reason}" + (f"; to run them: {command}" if command else ""))
    return lines


def closing_line(text):
    """ctest's own verdict, which CI systems look for."""
    found = re.findall(r"^\d+% tests passed, \d+ tests failed out of \d+.*$", text, re.MULTILINE)
    return found[-1] if found else ""


def clear(failed_folder):
    shutil.rmtree(failed_folder, ignore_errors=True)
