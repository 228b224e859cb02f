#!/usr/bin/env python3
"""Tests of cmake/fastddsgen4.py."""

import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "..")
SCRIPT = os.path.join(ROOT, "cmake", "fastddsgen4.py")
sys.path.append(os.path.dirname(SCRIPT))
import fastddsgen4  # noqa: E402  # pylint: disable=wrong-import-position

COMMON = """const unsigned long MAX_POINTS = 100;  // not [MAX_OLD]
const unsigned short NO_ZONE = 65535;
"""
SCAN = """#include "common.idl"
struct Scan {
  sequence<Point, MAX_POINTS> points;  // at most sequence<Point, MAX_OLD>
  sequence<string<32>, 4> names;
  double covariance[MAX_POINTS];
  sequence<octet> data;
};
"""
SCAN_WITH_NUMBERS = """#include "common.idl"
struct Scan {
  sequence<Point, 100> points;  \n  sequence<string<32>, 4> names;
  double covariance[100];
  sequence<octet> data;
};
"""
HEADER = """enum class Kind : int32_t
{
    kFirst
};
class Scan { Kind m_kind{Kind::kFirst}; };
"""
CODE = """void ScanPubSubType::register_type_object_representation()
{
    EPROSIMA_LOG_WARNING(XTYPES_TYPE_REPRESENTATION,
        "TypeObject type representation support disabled in generated code");
}
"""


class FastDdsGen4(unittest.TestCase):

    def test_bounds_are_the_numbers_of_their_constants(self):
        constants = {}
        fastddsgen4.with_numbers("common.idl", COMMON, constants)
        self.assertEqual(constants, {"MAX_POINTS": "100", "NO_ZONE": "65535"})
        self.assertEqual(fastddsgen4.with_numbers("scan.idl", SCAN, constants), SCAN_WITH_NUMBERS)

    def test_an_unknown_bound_is_named(self):
        with self.assertRaises(fastddsgen4.UnknownBound) as refused:
            fastddsgen4.with_numbers("scan.idl", SCAN, {})
        self.assertIn("scan.idl: the bound 'MAX_POINTS'", str(refused.exception))

    def test_the_command_prepares_and_finishes_files(self):
        with tempfile.TemporaryDirectory() as folder:
            def path(name, text=None):
                if text is not None:
                    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                        file.write(text)
                return os.path.join(folder, name)

            def content(name):
                with open(path(name), encoding="utf-8") as file:
                    return file.read()

            def run(step, staging, *files):
                return subprocess.run([sys.executable, SCRIPT, step, "--staging", path(staging), *files],
                                      capture_output=True, text=True, check=False)

            os.mkdir(path("idl"))
            files = [path("common.idl", COMMON), path("scan.idl", SCAN)]
            done = run("prepare", "idl", *files)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(content("idl/scan.idl"), SCAN_WITH_NUMBERS)
            refused = run("prepare", "idl", files[1])
            self.assertEqual(refused.returncode, 1)
            self.assertIn("MAX_POINTS", refused.stderr)

            path("scan.hpp", HEADER)
            path("scanPubSubTypes.cxx", CODE)
            done = run("finish", "", files[1])
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn("enum Kind : uint32_t\n", content("scan.hpp"))
            self.assertNotIn("LOG_WARNING", content("scanPubSubTypes.cxx"))


if __name__ == "__main__":
    unittest.main()
