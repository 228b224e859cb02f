#!/usr/bin/env python3
"""Tests of `./run test`: python3 runner_test.py [BUILD]."""

import contextlib
import functools
import io
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from unittest import mock

import changed
import costs
import quota
import run_tests
import summary

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.append(os.path.join(run_tests.ROOT, "cmake"))
import time_left  # noqa: E402  # pylint: disable=wrong-import-position
BUILD = sys.argv.pop(1) if len(sys.argv) > 1 and os.path.isdir(sys.argv[1]) else None
STAGES = summary.read_packages(os.path.join(run_tests.ROOT, "deploy", "packages.txt"))


class Project:
    """A project with tests of every outcome, in a folder of its own."""

    TESTS = """
add_test(NAME good.passes COMMAND sh -c "cat /proc/self/cgroup; ps -o ni= -p $$; exit 0")
add_test(NAME bad.Suite.fails/0 COMMAND sh -c "echo this went wrong; echo kept: /tmp/elsewhere; exit 1")
add_test(NAME script.skips COMMAND sh -c "echo skipped: docker is not installed; exit 77")
add_test(NAME script.skips_too COMMAND sh -c "echo skipped: docker is not installed; exit 77")
add_test(NAME unit.partly COMMAND printf "/a/b_test.cpp:16: Skipped\\nno logs here\\n\\n[  SKIPPED ] A.B (0 ms)\\n")
add_test(NAME gone.program COMMAND /nonexistent)
add_test(NAME slow.sleeps COMMAND sh -c "echo $$ > ${CMAKE_BINARY_DIR}/started; exec sleep 1000")
set_tests_properties(script.skips script.skips_too PROPERTIES SKIP_RETURN_CODE 77)
set_tests_properties(unit.partly PROPERTIES COST 7 RESOURCE_LOCK robot)
"""

    def __init__(self, folder):
        self.build = os.path.join(folder, "build")
        with open(os.path.join(folder, "CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write("cmake_minimum_required(VERSION 3.25)\nproject(x NONE)\nenable_testing()\n" + self.TESTS)
        subprocess.run(["cmake", "-S", folder, "-B", self.build], check=True, capture_output=True)

    def start(self, *words, **options):
        command = [sys.executable, os.path.join(HERE, "run_tests.py"), "--build", self.build, *words]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)

    def run(self, *words):
        runner = self.start(*words)
        output = runner.communicate()[0]
        return runner.returncode, output


@functools.cache
def shared_project():
    folder = tempfile.TemporaryDirectory()  # pylint: disable=consider-using-with
    unittest.addModuleCleanup(folder.cleanup)
    return Project(folder.name)


class RunnerTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()  # pylint: disable=consider-using-with
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def project(self):
        return shared_project()


class WholeRunTest(RunnerTest):
    def test_a_failure_says_how_to_run_it_again_and_where_its_files_are(self):
        project = self.project()
        status, output = project.run("good", "bad", "script", "unit", "gone")
        self.assertNotEqual(status, 0)
        self.assertIn("2 passed, 2 failed, 2 skipped", output)
        lines = output.splitlines()
        failed = next(i for i, line in enumerate(lines) if line.startswith("failed: bad.Suite.fails/0"))
        again = shlex.split(lines[failed + 1].removeprefix("  again: ./run test "))
        listed = subprocess.run(["ctest", "--test-dir", project.build, "-N", "-R", *again], capture_output=True,
                                text=True, check=True).stdout
        self.assertIn("Total Tests: 1\n", listed)
        self.assertIn("bad.Suite.fails/0", listed)
        folder = lines[failed + 2].removeprefix("  files: ")
        with open(os.path.join(run_tests.ROOT, folder, "output.txt"), encoding="utf-8") as file:
            self.assertIn("this went wrong", file.read())
        self.assertEqual(lines[failed + 3], "  files: /tmp/elsewhere")
        self.assertIn("failed: gone.program", output)

    def test_files_of_a_program_that_was_killed_are_kept(self):
        with tempfile.TemporaryDirectory() as temporary, mock.patch("tempfile.gettempdir", return_value=temporary):
            scratch = os.path.join(temporary, "topogeo_P_Suite.Case_0_123")
            os.makedirs(scratch)
            os.mkfifo(os.path.join(scratch, "pipe"))
            with open(os.path.join(scratch, "stderr1"), "w", encoding="utf-8") as file:
                file.write("why")
            failed = summary.Test("program.P/Suite.Case/0", 1200.0, "failed", "")
            folder = summary.keep_output([failed], self.folder)[failed.name][0]
            with open(os.path.join(folder, "topogeo_P_Suite.Case_0_123", "stderr1"), encoding="utf-8") as file:
                self.assertEqual(file.read(), "why")
            self.assertFalse(os.path.exists(scratch))

    def test_skipped_tests_have_a_line_for_each_reason_with_the_cure(self):
        _, output = self.project().run("script", "unit", "good")
        self.assertIn("skipped: script.skips, script.skips_too: docker is not installed; to run them: "
                      f"{summary.SUDO}tests/container/start_engine\n", output)
        self.assertIn("skipped: a part of unit.partly: no logs here\n", output)

    def test_the_closing_line_of_ctest_is_the_last(self):
        status, output = self.project().run("good", "unit")
        self.assertEqual(status, 0)
        self.assertEqual(output.splitlines()[-1], "100% tests passed, 0 tests failed out of 2")
        status, output = self.project().run("good", "bad")
        self.assertNotEqual(status, 0)
        self.assertEqual(output.splitlines()[-1], "50% tests passed, 1 tests failed out of 2")

    def test_repeats_are_counted_and_one_failure_fails_all(self):
        project = self.project()
        status, output = project.run("--repeat", "2", "good")
        self.assertEqual(status, 0)
        self.assertIn("2 of 2 runs were green", output)
        status, output = project.run("--repeat", "2", "bad")
        self.assertNotEqual(status, 0)
        self.assertIn("0 of 2 runs were green", output)
        self.assertTrue(os.path.exists(os.path.join(project.build, "tests/failed/bad.Suite.fails_0/output_2.txt")))

    def test_no_test_of_that_name_is_a_failure(self):
        self.assertNotEqual(self.project().run("nothing_of_that_name")[0], 0)

    def test_options_of_ctest_pass_through(self):
        self.assertIn("Total Tests: 1\n", self.project().run("-N", "-R", "good")[1])


class QuotaTest(RunnerTest):
    def group_of(self, output):
        found = re.search(r"by the control group (\S+)", output)
        return found[1] if found else None

    def test_tests_run_in_the_group_or_behind_the_loops(self):
        status, output = self.project().run("--cpus", "0.8", "-V", "good")
        self.assertEqual(status, 0, output)
        group = self.group_of(output)
        if group:
            self.assertIn("/" + os.path.basename(group), output.split("Start")[1])
            self.assertFalse(os.path.exists(group))
        else:
            self.assertRegex(output, r"busy loops leave about 0.8 cores")
            self.assertRegex(output, r"\n1: +15\n")

    def test_without_a_group_tests_run_behind_loops(self):
        project = self.project()
        output = io.StringIO()
        with mock.patch("quota.Group.make", return_value=None), contextlib.redirect_stderr(output):
            options = run_tests.parse(["--build", project.build, "--cpus", "0.8", "-V", "good"])
            log = os.path.join(project.build, "Testing", "output.log")
            with open(os.devnull, "w", encoding="utf-8") as null, contextlib.redirect_stdout(null):
                saved = os.dup(1)
                os.dup2(null.fileno(), 1)
                try:
                    status = run_tests.Runner(options).run()
                finally:
                    os.dup2(saved, 1)
                    os.close(saved)
        self.assertEqual(status, 0)
        self.assertIn("busy loops leave about 0.8 cores", output.getvalue())
        with open(log, encoding="utf-8") as file:
            self.assertRegex(file.read(), r"\n1: +15\n")

    def test_an_interruption_leaves_no_group_and_no_loop(self):
        for signal_number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=signal_number):
                project = self.project()
                started = os.path.join(project.build, "started")
                if os.path.exists(started):
                    os.remove(started)
                runner = project.start("--cpus", "0.8", "--beside", "2", "slow", start_new_session=True)
                while not os.path.exists(started) and runner.poll() is None:
                    time.sleep(0.05)  # between two checks
                # Like Ctrl-C in a terminal, which signals all; SIGTERM goes to the runner alone.
                if signal_number == signal.SIGINT:
                    os.killpg(runner.pid, signal_number)
                else:
                    runner.send_signal(signal_number)
                output = runner.communicate()[0]
                self.assertEqual(runner.returncode, 130, output)
                group = self.group_of(output)
                if group:
                    self.assertFalse(os.path.exists(group))
                left = subprocess.run(["pgrep", "-s", str(runner.pid)], capture_output=True, text=True,
                                      check=False).stdout
                self.assertEqual(left, "")

    def test_the_hierarchy_of_either_version_is_found(self):
        mounts = ("cgroup /sys/fs/cgroup/cpuset cgroup rw,cpuset 0 0\n"
                  "cgroup /sys/fs/cgroup/cpu,cpuacct cgroup rw,nosuid,cpu,cpuacct 0 0\n"
                  "cgroup2 /sys/fs/cgroup/unified cgroup2 rw 0 0\n")
        own = "4:cpuset:/\n3:cpu,cpuacct:/user.slice\n0::/user.slice/session-1.scope\n"
        self.assertEqual(quota.parent_groups(mounts, own, 1),
                         ["/sys/fs/cgroup/cpu,cpuacct/user.slice", "/sys/fs/cgroup/cpu,cpuacct"])
        self.assertEqual(quota.parent_groups(mounts, own, 2),
                         ["/sys/fs/cgroup/unified/user.slice/session-1.scope", "/sys/fs/cgroup/unified"])
        self.assertEqual(quota.parent_groups("cgroup2 /sys/fs/cgroup cgroup2 rw 0 0\n", "0::/\n", 2),
                         ["/sys/fs/cgroup"])
        self.assertEqual(quota.parent_groups("", own, 1), [])

    def test_a_group_has_a_period_of_ten_milliseconds(self):
        self.assertIn("echo 8000 > '/g/x/cpu.cfs_quota_us'", quota.quota_commands("/g/x", 0.8, 1))
        self.assertIn("echo 10000 > '/g/x/cpu.cfs_period_us'", quota.quota_commands("/g/x", 0.8, 1))
        self.assertIn("echo '15000 10000' > '/g/x/cpu.max'", quota.quota_commands("/g/x", 1.5, 2))

    def test_fewer_tests_run_side_by_side(self):
        with mock.patch("os.cpu_count", return_value=8):
            self.assertEqual(run_tests.jobs(None), 24)
            self.assertEqual(run_tests.jobs(0.8), 3)
            self.assertEqual(run_tests.jobs(2.5), 9)
            self.assertEqual(run_tests.jobs(64), 24)


class ArgumentsTest(unittest.TestCase):
    def test_words_are_names_and_options_of_ctest_keep_their_values(self):
        options = run_tests.parse(["unit_planning", "-L", "browser", "--cpus=0.8", "container[.]", "--repeat",
                                   "until-fail:3", "-j", "1", "--repeat", "5", "--beside", "4"])
        self.assertEqual(options.names, ["unit_planning", "container[.]"])
        self.assertEqual(options.ctest, ["-L", "browser", "--repeat", "until-fail:3", "-j", "1"])
        self.assertEqual((options.cpus, options.repeat, options.beside), (0.8, 5, 4))

    def test_changed_may_have_a_commit(self):
        self.assertEqual(run_tests.parse(["--changed"]).changed, "HEAD")
        self.assertEqual(run_tests.parse(["--changed", "-j1"]).changed, "HEAD")
        self.assertEqual(run_tests.parse(["--changed", "main~2"]).changed, "main~2")

    def test_nonsense_is_refused_with_its_value(self):
        for words in (["--cpus", "0"], ["--cpus", "many"], ["--beside", "1.5"], ["--repeat", "0"], ["--cpus"],
                      ["-R"]):
            with self.subTest(words=words), self.assertRaises(ValueError):
                run_tests.parse(words)


class PackagesTest(unittest.TestCase):
    """./run packages"""

    def packages(self, release, *stages):
        """Names of the packages of the stages for an /etc/os-release with these lines."""
        with tempfile.NamedTemporaryFile("w") as file:
            file.write(release)
            file.flush()
            return subprocess.run([os.path.join(run_tests.ROOT, "run"), "packages", *stages], check=True, text=True,
                                  capture_output=True, env=dict(os.environ, TOPOGEO_OS_RELEASE=file.name)).stdout.split()

    def test_releases_of_debian_share_a_list_but_for_the_names_that_differ(self):
        twelve = self.packages('NAME="Debian GNU/Linux"\nVERSION_ID="12"\nVERSION="12 (bookworm)"\n', "build")
        thirteen = self.packages('NAME="Debian GNU/Linux"\nVERSION_ID="13"\nVERSION="13 (trixie)"\n', "build")
        self.assertIn("libfastrtps-dev", twelve)
        self.assertNotIn("libfastdds-dev", twelve)
        self.assertIn("libfastdds-dev", thirteen)
        self.assertNotIn("libfastrtps-dev", thirteen)
        self.assertEqual(set(twelve) - {"libfastrtps-dev"}, set(thirteen) - {"libfastdds-dev"})

    def test_an_unknown_release_gets_the_newest_list(self):
        self.assertIn("libfastdds-dev", self.packages("VERSION_ID=14\n", "build"))
        self.assertIn("libfastdds-dev", self.packages("NAME=elsewhere\n", "build"))

    def test_packages_of_one_release_have_their_stage(self):
        self.assertEqual(STAGES["libfastdds-dev"], "build")
        self.assertEqual(STAGES["libfastrtps-dev"], "build")


class SummaryTest(unittest.TestCase):
    def test_each_missing_thing_has_the_command_that_installs_it(self):
        self.assertEqual(summary.cure("chromium-headless-shell is not installed", STAGES), "tests/browser/install")
        self.assertEqual(summary.cure("tsc is not installed", STAGES), "./run packages --install check")
        self.assertEqual(summary.cure("faketime is not installed", STAGES), "./run packages --install container")
        self.assertEqual(summary.cure("no container engine runs (tests/container/start_engine starts one)", STAGES),
                         summary.SUDO + "tests/container/start_engine")
        self.assertEqual(summary.cure("the page is not built", STAGES), "")

    def test_all_that_scripts_need_has_a_cure(self):
        names = set()
        for folder, _, files in os.walk(os.path.join(run_tests.ROOT, "tests")):
            for name in files:
                if name.endswith(".sh"):
                    with open(os.path.join(folder, name), encoding="utf-8") as file:
                        names |= set(re.findall(r"^ *(?:need|there) ([a-z][a-z0-9_-]*)$", file.read(), re.MULTILINE))
        self.assertIn("docker", names)
        for name in names:
            self.assertNotEqual(summary.cure(f"{name} is not installed", STAGES), "", name)

    def test_names_with_signs_of_regular_expressions_match_themselves(self):
        self.assertEqual(summary.pattern("a.B/c(1, [2])"), "^a.B/c\\(1, \\[2\\]\\)$")


class ChangedTest(RunnerTest):
    # The planner and its unit test use planning; only its own service uses web.
    ENTRIES = [
        {"id": "1", "name": "topogeo_planning", "type": "STATIC_LIBRARY", "paths": {"source": "libs/planning"}},
        {"id": "2", "name": "unit_planning", "type": "EXECUTABLE", "paths": {"source": "tests/unit/planning"},
         "dependencies": [{"id": "1"}]},
        {"id": "3", "name": "planner", "type": "EXECUTABLE", "paths": {"source": "services/planner"},
         "dependencies": [{"id": "1"}]},
        {"id": "4", "name": "integration_topogeo", "type": "EXECUTABLE", "paths": {"source": "tests/integration"},
         "dependencies": [{"id": "3"}]},
        {"id": "6", "name": "page", "type": "UTILITY", "paths": {"source": "services/planner/page"}},
        {"id": "5", "name": "unit_scan", "type": "EXECUTABLE", "paths": {"source": "tests/unit/scan"}},
    ]
    TESTS = [
        {"name": "unit_planning.Route", "command": ["/r/build/tests/unit_planning"]},
        {"name": "integration_topogeo.A.b", "command": ["/r/build/tests/integration_topogeo"]},
        {"name": "unit_scan.Scan", "command": ["/r/build/tests/unit_scan"]},
        {"name": "container.drive", "command": ["/usr/bin/bash", "/r/tests/container/drive_test.sh", "/r/build"]},
        {"name": "browser.page", "command": ["/usr/bin/bash", "/r/tests/browser/page_test.sh", "/r/build"]},
        {"name": "integration.examples", "command": ["/usr/bin/bash", "/r/tests/integration/examples_test.sh"]},
        {"name": "runner.runner", "command": ["/usr/bin/python3", "/r/tests/runner/runner_test.py", "/r/build"]},
    ]
    DEPS = ("tests/unit/planning/CMakeFiles/unit_planning.dir/a.cpp.o: #deps 2, deps mtime 1 (VALID)\n"
            "    /r/tests/unit/planning/a_test.cpp\n    /usr/include/stdio.h\n\n"
            "tests/unit/scan/CMakeFiles/unit_scan.dir/a.cpp.o: #deps 2, deps mtime 1 (VALID)\n"
            "    ../tests/unit/waiting.hpp\n    /r/tests/unit/scan/scan_test.cpp\n\n")

    def reached(self, *files):
        targets = changed.Targets("/r", self.ENTRIES)
        compiled_by = changed.parse_deps(self.DEPS, "/r", "/r/build")
        return changed.reached_tests(files, targets, compiled_by, self.TESTS, "/r", {"unit_scan"})

    def test_a_library_reaches_its_test_its_users_and_what_starts_services(self):
        # A header without includes so far.
        self.assertEqual(self.reached("libs/planning/include/topogeo/planning/new.hpp") - {"unit_scan.Scan"},
                         {"unit_planning.Route", "integration_topogeo.A.b", "container.drive", "browser.page",
                          "integration.examples"})

    def test_a_test_source_reaches_its_program_alone(self):
        self.assertEqual(self.reached("tests/unit/planning/a_test.cpp"), {"unit_planning.Route"})
        self.assertEqual(self.reached("tests/unit/waiting.hpp"), {"unit_scan.Scan"})

    def test_a_script_reaches_those_of_its_folder_and_what_they_share_all(self):
        self.assertEqual(self.reached("tests/browser/page_test.mjs") - {"unit_scan.Scan"}, {"browser.page"})
        self.assertEqual(self.reached("tests/container/schemas/package.json") - {"unit_scan.Scan"}, {"container.drive"})
        self.assertLessEqual({"browser.page", "container.drive"}, self.reached("tests/container/common.sh"))

    def test_a_file_of_a_service_that_no_compiler_reads_reaches_its_tests(self):
        self.assertEqual(self.reached("services/planner/page/app.ts") - {"unit_scan.Scan"},
                         {"integration_topogeo.A.b", "container.drive", "browser.page",
                          "integration.examples"})

    def test_an_example_reaches_the_test_that_builds_it(self):
        self.assertEqual(self.reached("examples/follow_map/main.cpp") - {"unit_scan.Scan"}, {"integration.examples"})

    def test_the_build_reaches_all_and_a_page_of_docs_who_reads_it(self):
        everything = {test["name"] for test in self.TESTS}
        for path in ("cmake/TopogeoTargets.cmake", "CMakeLists.txt", "idl/scan.idl", "share/worlds/room.world.yaml",
                     "tests/data/map_v1.sql"):
            self.assertEqual(self.reached(path), everything, path)
        self.assertEqual(self.reached("docs/mapping.md"), {"unit_scan.Scan"})
        self.assertEqual(self.reached("run"), {"runner.runner"})
        self.assertEqual(self.reached(), set())

    def test_patterns_choose_the_same_tests(self):
        patterns = changed.patterns_of({"unit_scan.Scan", "container.drive"}, self.TESTS + [{"name": "container.x"}])
        self.assertEqual(patterns, ["^container.drive$", "^unit_scan[.]"])

    def test_new_deleted_and_uncommitted_files_differ(self):
        def git(*words):
            subprocess.run(["git", "-C", self.folder, "-c", "user.name=a", "-c", "user.email=a@b", *words], check=True,
                           capture_output=True)

        def write(name):
            with open(os.path.join(self.folder, name), "a", encoding="utf-8") as file:
                file.write("x\n")

        git("init")
        for name in ("kept", "edited", "deleted"):
            write(name)
        git("add", ".")
        git("commit", "-m", "first")
        write("edited")
        write("new")
        os.remove(os.path.join(self.folder, "deleted"))
        self.assertEqual(changed.changed_files(self.folder, "HEAD"), ["deleted", "edited", "new"])
        with self.assertRaises(ValueError):
            changed.changed_files(self.folder, "nothing")


class CostsTest(RunnerTest):
    def test_tests_with_a_lock_cost_what_waits_behind_them(self):
        seconds = {"a": 10.0, "b": 30.0, "c": 20.0, "free": 25.0}
        locks = {"a": ["robot"], "b": ["robot"], "c": ["robot"]}
        self.assertEqual(costs.costs_of(seconds, locks), {"a": 10.0, "c": 30.0, "b": 60.0, "free": 25.0})

    def test_a_table_keeps_what_did_not_run_and_leaves_out_what_is_gone_or_set_by_hand(self):
        path = os.path.join(self.folder, "costs.txt")
        with open(path, "w", encoding="utf-8") as file:
            file.write("# text\n5 kept\n6 gone\n7 measured\n")
        listing = {"tests": [{"name": name, "properties": [{"name": "COST", "value": 1.0}] if cost else []}
                             for name, cost in (("kept", 1), ("measured", 1), ("by_hand", 1), ("quick", 0))]}
        tests = [summary.Test(name, seconds, state, "") for name, seconds, state in
                 (("measured", 9.2, "passed"), ("by_hand", 50, "passed"), ("quick", 0.1, "passed"),
                  ("kept", 99, "failed"))]
        costs.save_costs(path, tests, listing)
        self.assertEqual(costs.read_costs(path), {"measured": 9, "kept": 5})


class TimeLeftTest(RunnerTest):
    PLAN = ["10.0 a.o", "10.0 b.o", "20.0 c.o", "0.5 generated.h"]

    def test_nothing_is_said_in_the_first_minute_or_before_a_step_is_done(self):
        self.assertIsNone(time_left.seconds_left(self.PLAN, "0\t30000\t1\ta.o\thash\n", 59, 2))
        self.assertIsNone(time_left.seconds_left(self.PLAN, "", 100, 2))

    def test_what_is_left_counts_by_its_weight(self):
        # One core, 10 of 40.5 done in 60 s.
        left = time_left.seconds_left(self.PLAN, "0\t60000\t1\ta.o\thash\n", 60, 1)
        self.assertAlmostEqual(left, 60 * 40.5 / 10 - 60)
        # Half of the steps by number, a quarter by weight.
        log = "0\t59000\t1\ta.o\thash\n59000\t60000\t1\tgenerated.h\tother\n"
        self.assertAlmostEqual(time_left.seconds_left(self.PLAN, log, 60, 1), 60 * 40.5 / 10.5 - 60)

    def test_a_step_with_several_outputs_counts_once(self):
        log = "0\t60000\t1\ta.o\thash\n0\t60000\t1\ta.h\thash\n"
        self.assertAlmostEqual(time_left.seconds_left(self.PLAN, log, 60, 1), 60 * 40.5 / 10 - 60)

    def test_a_unit_weighs_what_it_includes(self):
        unit = os.path.join(self.folder, "libs/CMakeFiles/x.dir/Unity/unity_0_cxx.cxx")
        os.makedirs(os.path.dirname(unit))
        source = os.path.join(self.folder, "a.cpp")
        with open(source, "w", encoding="utf-8") as file:
            file.write("x" * 50000)
        with open(unit, "w", encoding="utf-8") as file:
            file.write(f'#include "{source}"\n')
        self.assertAlmostEqual(time_left.weight(self.folder, "libs/CMakeFiles/x.dir/Unity/unity_0_cxx.cxx.o"),
                               time_left.UNIT_WEIGHT + 50 * time_left.WEIGHT_OF_KB)
        self.assertEqual(time_left.weight(self.folder, "bin/topogeo"), time_left.OTHER_WEIGHT)

    def test_it_is_said_in_minutes(self):
        self.assertEqual(time_left.in_words(20), "about a minute left")
        self.assertEqual(time_left.in_words(170), "about 3 minutes left")


@unittest.skipUnless(BUILD, "needs the build folder")
class BuildTest(unittest.TestCase):
    def test_every_test_that_was_lost_to_time_is_still_there(self):
        listed = subprocess.run(["ctest", "--test-dir", BUILD, "-N"], capture_output=True, text=True, check=True).stdout
        there = re.findall(r"^ *Test +#\d+: (.+)$", listed, re.MULTILINE)
        if any(name.endswith("_NOT_BUILT") for name in there):
            self.skipTest("not all programs are built")
        for pattern in run_tests.time_tests("all"):
            with self.subTest(pattern=pattern):
                self.assertTrue(any(re.search(pattern, name) for name in there))


if __name__ == "__main__":
    unittest.main()
