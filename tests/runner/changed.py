"""Which tests the difference to a commit can reach.

From a changed source or header to the targets that compile it, by what the compiler reported to Ninja; from those to
all targets that depend on them, by the File API of CMake; from any other file to the targets of its folder. A script
test starts programs of the services, so it is reached with any of them. In doubt a test is reached.
"""

import glob
import json
import os
import re
import subprocess

# Files on which any target may depend without CMake knowing.
ALL = re.compile(r"(CMakeLists\.txt|CMakePresets\.json|tests/CMakeLists\.txt|cmake/.*|idl/.*|share/.*|tests/data/.*)$")
RUNNER = re.compile(r"(run|\.ci/.*|\.github/.*|tests/runner/.*|tests/costs\.txt|deploy/packages\.txt)$")
QUERY = ".cmake/api/v1/query/codemodel-v2"  # with this file in the build folder CMake describes the targets


class Targets:
    """Targets of the build, with their folders and who depends on them."""

    def __init__(self, root, entries):
        """`entries`: objects of the File API, codemodel version 2."""
        self._root = root
        self._folders = {}
        self._users = {}
        names = {entry["id"]: entry["name"] for entry in entries}
        for entry in entries:
            self._folders[entry["name"]] = entry["paths"]["source"]
            for dependency in entry.get("dependencies", []):
                self._users.setdefault(names[dependency["id"]], set()).add(entry["name"])
        self.programs = {entry["name"] for entry in entries if entry["type"] == "EXECUTABLE"}

    @staticmethod
    def read(root, build):
        reply = os.path.join(build, ".cmake/api/v1/reply")
        with open(max(glob.glob(f"{reply}/index-*.json")), encoding="utf-8") as file:
            model = json.load(file)["reply"]["codemodel-v2"]["jsonFile"]
        with open(f"{reply}/{model}", encoding="utf-8") as file:
            targets = json.load(file)["configurations"][0]["targets"]
        entries = []
        for target in targets:
            with open(f"{reply}/{target['jsonFile']}", encoding="utf-8") as file:
                entries.append(json.load(file))
        return Targets(root, entries)

    def of_folders(self, path):
        """Targets that the folders around the file define; the root defines none of interest."""
        found = set()
        folder = os.path.dirname(path)
        while folder:
            found |= {name for name, home in self._folders.items() if home == folder}
            folder = os.path.dirname(folder)
        return found

    def in_services(self, names):
        return {name for name in names & self.programs if self._folders[name].startswith("services/")}

    def with_users(self, names):
        reached = set()
        waiting = list(names)
        while waiting:
            name = waiting.pop()
            if name not in reached:
                reached.add(name)
                waiting += self._users.get(name, ())
        return reached


def parse_deps(text, root, build):
    """Targets that compile each file of the source folder, from what `ninja -t deps` prints."""
    compiled_by = {}
    target = None
    for line in text.splitlines():
        if line.startswith("    "):
            path = os.path.normpath(os.path.join(build, line.strip()))
            if target and path.startswith(root + "/"):
                compiled_by.setdefault(os.path.relpath(path, root), set()).add(target)
        elif line:
            found = re.search(r"CMakeFiles/([^/]+)\.dir/", line)
            target = found[1] if found else None
    return compiled_by


def changed_files(root, commit):
    """Files that differ from the commit, in whichever state: also deleted ones and those not yet added."""
    git = ["git", "-c", f"safe.directory={root}", "-C", root]
    if subprocess.run(git + ["rev-parse", "-q", "--verify", f"{commit}^{{commit}}"], capture_output=True,
                      check=False).returncode != 0:
        raise ValueError(f"'{commit}' is no commit")
    lines = []
    for command in (["diff", "--name-only", "--no-renames", commit, "--"],
                    ["ls-files", "--others", "--exclude-standard"]):
        lines += subprocess.run(git + command, capture_output=True, text=True, check=True).stdout.splitlines()
    return sorted(set(lines))


def script_of(test, root):
    """The script of a script test, relative to the source folder; empty for a program."""
    command = test.get("command", [])
    for word in command[:2]:
        if word.startswith(root + "/") and word.endswith((".sh", ".py")):
            return os.path.relpath(word, root)
    return ""


def reached_tests(files, targets, compiled_by, tests, root, readers=frozenset()):
    """Names of the tests that a change of the files can reach. `tests`: of `ctest --show-only=json-v1`; `readers`:
    targets that read other files of the source folder."""
    if any(ALL.match(path) for path in files):
        return {test["name"] for test in tests}
    direct = set()
    folders = set()
    runner = False
    for path in files:
        if RUNNER.match(path):
            runner = True
        elif path in compiled_by:
            direct |= compiled_by[path]
        else:
            direct |= targets.of_folders(path) | readers
            folders.add(os.path.dirname(path))
    reached = targets.with_users(direct)
    # All scripts share tests/container/common.sh; tests of containers use the files of deploy/; integration.examples
    # uses those of examples/.
    all_scripts = bool(targets.in_services(reached)) or "tests/container/common.sh" in files
    deployed = any(path.startswith("deploy/") for path in files)
    names = set()
    for test in tests:
        script = script_of(test, root)
        home = os.path.dirname(script)
        if home == "tests/runner":
            hit = runner
        elif script:
            hit = all_scripts or (deployed and home == "tests/container") or any(
                (folder + "/").startswith(home + "/") or folder == "tests/" + test["name"].split(".")[0] or
                folder.split("/")[0] == test["name"].split(".")[1] for folder in folders)
        else:
            hit = os.path.basename(test.get("command", [""])[0]) in reached
        if hit:
            names.add(test["name"])
    return names


def targets_that_read(root, compiled_by):
    """Test programs that read files of the source folder when they run."""
    readers = set()
    for path, names in compiled_by.items():
        if path.startswith("tests/"):
            try:
                with open(os.path.join(root, path), encoding="utf-8") as file:
                    if "TOPOGEO_SOURCE_DIR" in file.read():
                        readers |= names
            except OSError:
                pass
    return readers


def patterns_of(names, tests):
    """Regular expressions for ctest: one for each program of which all tests are wanted, else one for each test."""
    of_program = {}
    for test in tests:
        of_program.setdefault(test["name"].split(".")[0], set()).add(test["name"])
    patterns = []
    for program, all_of_it in sorted(of_program.items()):
        if all_of_it <= names:
            patterns.append(f"^{program}[.]")
        else:
            patterns += [f"^{name}$" for name in sorted(all_of_it & names)]
    return patterns


def find(root, build, commit, tests):
    """Changed files, and names of the tests that they reach."""
    files = changed_files(root, commit)
    targets = Targets.read(root, build)
    deps = subprocess.run(["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True, check=True).stdout
    compiled_by = parse_deps(deps, root, build)
    readers = targets_that_read(root, compiled_by)
    return files, reached_tests(files, targets, compiled_by, tests, root, readers)
