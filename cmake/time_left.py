#!/usr/bin/env python3
"""Estimates how long a build goes on, from what Ninja has still to do and how long it took for what it has done.

  time_left.py plan BUILD [TARGET...] > PLAN    before the build: each step with its weight
  time_left.py left BUILD PLAN SECONDS          prints "about 3 minutes left", SECONDS after the build began; nothing
                                                in the first minute

Units of several files take from one second to a minute, so steps count by what they compile: a start, the headers,
and the length of the sources.
"""

import os
import re
import shutil
import subprocess
import sys

UNIT_WEIGHT = 4.0  # the headers of a unit, seconds on a fast core
WEIGHT_OF_KB = 0.2
OTHER_WEIGHT = 0.5  # links, generated files


def sources_of(build, output):
    """The source of an object file, or those of its unit of several files."""
    found = re.match(r"(.*?)/?CMakeFiles/[^/]+\.dir/(.*)\.o$", output)
    if not found:
        return []
    unit = os.path.join(build, output[:-2])
    if "/Unity/" in output and os.path.exists(unit):
        with open(unit, encoding="utf-8") as file:
            return re.findall(r'#include "([^"]+)"', file.read())
    return [os.path.join(build, "..", found[1], found[2])]


def weight(build, output):
    if not output.endswith(".o"):
        return OTHER_WEIGHT
    size = sum(os.path.getsize(path) for path in sources_of(build, output) if os.path.exists(path))
    return UNIT_WEIGHT + WEIGHT_OF_KB * size / 1000


def plan(build, targets):
    """Lines "weight output" of what Ninja is going to do; first the length of its log, which then grows."""
    # With the original name, Ninja would first remake build.ninja and show nothing else.
    manifest = os.path.join(build, ".time_left.ninja")
    shutil.copyfile(os.path.join(build, "build.ninja"), manifest)
    steps = subprocess.run(["ninja", "-C", build, "-f", os.path.basename(manifest), "-n", *targets], capture_output=True, text=True,
                           check=False).stdout
    try:
        length = os.path.getsize(os.path.join(build, ".ninja_log"))
    except OSError:
        length = 0
    lines = [str(length)]
    for step in re.findall(r"^\[\d+/\d+\] (.*)$", steps, re.MULTILINE):
        output = step.split()[-1] if step else "?"
        lines.append(f"{weight(build, output):.2f} {output}")
    return lines


def seconds_left(plan_lines, log, elapsed_s, jobs):
    """None where nothing can be said yet. `log`: what Ninja has added to its log, a line for each output of a step."""
    weights = {}
    total = 0.0
    for line in plan_lines:
        step_weight, output = line.split(" ", 1)
        weights[output] = float(step_weight)
        total += float(step_weight)
    done = 0.0
    spent_s = 0.0
    steps = set()
    for line in log.splitlines():
        fields = line.split("\t")
        # One command may make several files, which have the same times and hash.
        if len(fields) != 5 or (fields[0], fields[4]) in steps:
            continue
        steps.add((fields[0], fields[4]))
        done += weights.get(fields[3], OTHER_WEIGHT)
        spent_s += (int(fields[1]) - int(fields[0])) / 1000
    if done <= 0.0 or elapsed_s < 60:
        return None
    # Running steps are in no log: the total of all steps, less the time that has passed.
    side_by_side = max(1.0, min(jobs, spent_s / elapsed_s * 1.25))
    return max(0.0, total * spent_s / done / side_by_side - elapsed_s)


def in_words(seconds):
    minutes = round(seconds / 60)
    return "about a minute left" if minutes <= 1 else f"about {minutes} minutes left"


def main(words):
    if len(words) >= 2 and words[0] == "plan":
        print("\n".join(plan(words[1], words[2:])))
        return 0
    if len(words) != 4 or words[0] != "left":
        print(__doc__, file=sys.stderr)
        return 2
    build, elapsed_s = words[1], float(words[3])
    with open(words[2], encoding="utf-8") as file:
        length, *lines = file.read().splitlines() or ["0"]
    try:
        with open(os.path.join(build, ".ninja_log"), encoding="utf-8") as log:
            log.seek(int(length))
            left = seconds_left(lines, log.read(), elapsed_s, (os.cpu_count() or 1) + 1)
    except OSError:
        left = None
    if left is not None:
        print(in_words(left))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
