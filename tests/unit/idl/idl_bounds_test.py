#!/usr/bin/env python3
"""Tests of cmake/idl_bounds.py."""

import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "..")
SCRIPT = os.path.join(ROOT, "cmake", "idl_bounds.py")
sys.path.append(os.path.dirname(SCRIPT))
import idl_bounds  # noqa: E402  # pylint: disable=wrong-import-position

IDL = """
typedef unsigned long long Stamp;
const unsigned long MAX_POINTS = 100;  // sequence<Point, 5> in a comment
enum Kind {
  FIRST,
  LAST
};
struct Point {
  double x_m;
  float y_m;
};
struct Scan {
  unsigned long schema_version;
  @key string<64> robot_id;
  unsigned long long robot_key;
  Kind kind;
  Stamp stamp_ns;
  sequence<Point, MAX_POINTS> points;
};
struct Log {
  Scan last;
  sequence<Scan, 7> scans;
};
"""

CODE = """#include <fastcdr/Cdr.h>
void topogeo::msg::Point::deserialize(Cdr& dcdr) {
    dcdr >> m_x_m;
}
void topogeo::msg::Scan::deserialize(Cdr& dcdr) {
    dcdr >> m_kind;
    dcdr >> m_points;
}
void topogeo::msg::Log::deserialize(Cdr& dcdr) {
    dcdr >> m_last;
    dcdr >> m_scans;
}
"""

BOUNDED_CODE = """#include <fastcdr/Cdr.h>

#include "read_bounded.h"
void topogeo::msg::Point::deserialize(Cdr& dcdr) {
    dcdr >> m_x_m;
}
void topogeo::msg::Scan::deserialize(Cdr& dcdr) {
    dcdr >> m_kind;
    topogeo::msg::read_bounded(dcdr, m_points, topogeo::msg::MAX_POINTS);
}
void topogeo::msg::Log::deserialize(Cdr& dcdr) {
    dcdr >> m_last;
    topogeo::msg::read_bounded(dcdr, m_scans, topogeo::msg::7);
}
"""

CODE_4 = """#include <fastcdr/Cdr.h>
void serialize(
        eprosima::fastcdr::Cdr& scdr,
        const topogeo::msg::Scan& data)
{
    scdr << data.points();
}
void deserialize(
        eprosima::fastcdr::Cdr& cdr,
        topogeo::msg::Scan& data)
{
    cdr.deserialize_type([&data](Cdr& dcdr) {
        dcdr >> data.points();
    });
}
void deserialize(
        eprosima::fastcdr::Cdr& cdr,
        topogeo::msg::Log& data)
{
    cdr.deserialize_type([&data](Cdr& dcdr) {
        dcdr >> data.scans();
    });
}
"""

BOUNDED_CODE_4 = CODE_4.replace("#include <fastcdr/Cdr.h>\n", '#include <fastcdr/Cdr.h>\n\n#include "read_bounded.h"\n').replace(
    "dcdr >> data.points();", "topogeo::msg::read_bounded(dcdr, data.points(), topogeo::msg::MAX_POINTS);").replace(
        "dcdr >> data.scans();", "topogeo::msg::read_bounded(dcdr, data.scans(), topogeo::msg::7);")

CHECKS = """
template <class Check>
void visit_bounds(const Scan& message, Check& check) {
  check.schema(message.schema_version());
  check.key("robot_key", message.robot_key(), message.robot_id());
  check.value("kind", message.kind(), LAST);
  check.size("points", message.points().size(), MAX_POINTS);
}

template <class Check>
void visit_bounds(const Log& message, Check& check) {
  check.inside("last", [&] { visit_bounds(message.last(), check); });
  check.size("scans", message.scans().size(), 7);
  check.inside("scans", [&] {
    for (const Scan& entry : message.scans()) visit_bounds(entry, check);
  });
}
"""


def struct(member):
    return "struct Scan {\n  " + member + ";\n};\n"


class IdlBounds(unittest.TestCase):

    def test_each_member_that_can_be_wrong_is_checked(self):
        bounds = idl_bounds.Bounds()
        self.assertEqual(bounds.add("scan.idl", IDL, CODE), BOUNDED_CODE)
        self.assertEqual(bounds.functions, CHECKS)

    def test_the_code_of_fastddsgen_4_keeps_the_same_bounds(self):
        bounds = idl_bounds.Bounds(idl_bounds.GENERATORS["4"])
        self.assertEqual(bounds.add("scan.idl", IDL, CODE_4), BOUNDED_CODE_4)
        self.assertEqual(bounds.functions, CHECKS)
        with self.assertRaises(idl_bounds.BoundsError):
            idl_bounds.Bounds(idl_bounds.GENERATORS["4"]).add("scan.idl", IDL, CODE)

    def test_a_type_of_an_earlier_file_is_known(self):
        bounds = idl_bounds.Bounds()
        bounds.add("scan.idl", IDL, CODE)
        code = "void topogeo::msg::Drive::deserialize(Cdr& dcdr) {\n    dcdr >> m_logs;\n}\n"
        bounds.add("drive.idl", "struct Drive {\n  sequence<Log, 2> logs;\n};\n", code)
        self.assertIn("visit_bounds(entry, check)", bounds.functions.split("const Drive&")[1])

    def test_a_member_that_it_does_not_understand_is_named(self):
        for member in ("Unknown point", "sequence<Unknown, 5> points", "string name", "double x_m, y_m",
                       "unsigned long long robot_key"):
            with self.subTest(member), self.assertRaises(idl_bounds.BoundsError) as refused:
                idl_bounds.Bounds().add("a.idl", struct(member), CODE)
            self.assertIn(f"a.idl: Scan: expected a member 'type name' with a known type: '{member}'",
                          str(refused.exception))

    def test_a_sequence_that_no_code_reads_is_named(self):
        for member, code in (("ranges_m", CODE), ("points", CODE.replace("Scan::", "Other::"))):
            with self.subTest(member), self.assertRaises(idl_bounds.BoundsError) as refused:
                idl_bounds.Bounds().add("a.idl", struct(f"sequence<float, 5> {member}"), code)
            self.assertIn("no code reads", str(refused.exception))

    def test_the_command_writes_code_and_header_or_says_why_not(self):
        with tempfile.TemporaryDirectory() as folder:
            def path(name, text=None):
                if text is not None:
                    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                        file.write(text)
                return os.path.join(folder, name)

            def run(idl, *options):
                return subprocess.run([sys.executable, SCRIPT, "--staging", folder, "--output", path("bounds.h"), *options,
                                       idl],
                                      capture_output=True, text=True, check=False)

            path("scan.cxx", CODE)
            done = run(path("scan.idl", IDL))
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            with open(path("bounds.h"), encoding="utf-8") as header, open(path("scan.cxx"), encoding="utf-8") as code:
                self.assertIn(CHECKS, header.read())
                self.assertEqual(code.read(), BOUNDED_CODE)

            path("scanCdrAux.ipp", CODE_4)
            done = run(path("scan.idl", IDL), "--generator", "4")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            with open(path("scanCdrAux.ipp"), encoding="utf-8") as code:
                self.assertEqual(code.read(), BOUNDED_CODE_4)

            path("bad.cxx", CODE)
            refused = run(path("bad.idl", struct("Unknown point")))
            self.assertEqual(refused.returncode, 1)
            self.assertIn("bad.idl: Scan: expected", refused.stderr)


if __name__ == "__main__":
    unittest.main()
