"""Tests of the division of sources into units of several files (cmake/unity_groups.py)."""
import os
import subprocess
import sys
import tempfile
import unittest

CMAKE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "cmake")
sys.path.insert(0, CMAKE)
import unity_groups  # noqa: E402


def in_anonymous(code):
    """Names of code in an anonymous namespace of topogeo."""
    found = unity_groups.names_in("namespace topogeo {\nnamespace {\n" + code + "\n}\n}\n")
    return {(name, detail) for scope, name, detail in found if scope == "topogeo"}


class NamesTest(unittest.TestCase):
    def test_finds_constants_types_functions_and_aliases(self):
        self.assertEqual(in_anonymous("""
            constexpr double kStep_m = 0.5;          // a comment with int other;
            const std::vector<std::pair<int, int>> kPairs{{1, 2}, {3, 4U}};
            struct Row { int value = 0; void add(int one) { value += one; } };
            enum class Kind : std::uint8_t { kOne, kTwo };
            template <typename T> T doubled(const T& value, int times = 2) { int local = 1; return value; }
            [[nodiscard]] bool is_right(const std::string& text) { return text == "int hidden() {"; }
            using Json = nlohmann::json;
            using geometry::Pose2;
            auto kCall = [](int x) { return x; }(3);
            """), {("kStep_m", ""), ("kPairs", ""), ("Row", ""), ("Kind", ""), ("kCall", ""), ("Json", "=nlohmann::json"),
                   ("doubled", "(1,2)"), ("is_right", "(1,1)")})

    def test_leaves_out_what_others_may_define(self):
        self.assertEqual(in_anonymous("""
            TEST(Suite, Case) { int local = 0; }
            std::optional<int> Fixture::shared_;
            bool operator==(const Row& a, const Row& b) { return true; }
            """), set())
        self.assertEqual(unity_groups.names_in("namespace topogeo { int seen() { return 1; } }"), [])

    def test_finds_static_functions_and_nested_namespaces(self):
        self.assertEqual(unity_groups.names_in("static int a(int x) { return x; }\n"
                                               "namespace t::u { namespace { int b = 1'000U; } }"),
                         [("", "a", "(1,1)"), ("t::u", "b", "")])


class DivisionTest(unittest.TestCase):
    def divided(self, *files, largest=0):
        names = {str(i): unity_groups.names_in(f"namespace {{ {code} }}") for i, code in enumerate(files)}
        return unity_groups.divided(list(names), names, largest)

    def test_fills_units_in_order(self):
        self.assertEqual(self.divided("int a;", "int b;", "int c;", "int d;", "int e;", largest=2), [0, 0, 1, 1, 2])
        self.assertEqual(self.divided("int a;", "int b;", "int c;"), [0, 0, 0])

    def test_puts_a_repeated_name_into_another_unit(self):
        self.assertEqual(self.divided("int a;", "int a;", "int b;", "int a;"), [0, 1, 0, 2])
        self.assertEqual(self.divided("int f(int x) {}", "int f(int y) {}"), [0, 1])
        self.assertEqual(self.divided("using J = int;", "using J = long;"), [0, 1])
        self.assertEqual(self.divided("struct f {};", "int f(int y) {}"), [0, 1])

    def test_separates_functions_that_one_call_may_mean(self):
        self.assertEqual(self.divided("int f(int x) {}", "int f(double x) {}"), [0, 1])
        self.assertEqual(self.divided("int f() {}", "int f(int x = 1) {}"), [0, 1])
        self.assertEqual(self.divided("int f() {}", "int f(std::array<int, 2> x = {1, 2}) {}"), [0, 1])
        self.assertEqual(self.divided("template <class... T> int f(T... x) {}", "int f(int a, int b) {}"), [0, 1])

    def test_keeps_functions_of_other_counts_and_equal_aliases_together(self):
        self.assertEqual(self.divided("int f() {}", "int f(int x) {}", "int f(std::map<int, int> x, int y) {}"), [0, 0, 0])
        self.assertEqual(self.divided("int f(void) {}", "int f(const std::string& x) {}"), [0, 0])
        self.assertEqual(self.divided("using J = int;", "using J = int;"), [0, 0])

    def test_notices_a_changed_file(self):
        with tempfile.TemporaryDirectory() as folder:
            paths = [os.path.join(folder, name) for name in ("a.cpp", "b.cpp", "made_later.cpp")]
            with open(os.path.join(folder, "lines"), "w", encoding="utf-8") as file:
                file.writelines(f"target\t16\t{path}\n" for path in paths)

            def units(first, second):
                for path, code in zip(paths, (first, second)):
                    with open(path, "w", encoding="utf-8") as file:
                        file.write(f"namespace {{ {code} }}\n")
                    os.utime(path, ns=(len(code), len(code)))
                lines = subprocess.run([sys.executable, f"{CMAKE}/unity_groups.py", f"{folder}/lines", f"{folder}/cache"],
                                       check=True, capture_output=True, text=True).stdout.splitlines()
                self.assertEqual([line.split("\t")[2] for line in lines], paths)
                return [int(line.split("\t")[1]) for line in lines]

            self.assertEqual(units("int a;", "int b;"), [0, 0, 0])
            self.assertEqual(units("int a;", "int  a;"), [0, 1, 0])


if __name__ == "__main__":
    unittest.main()
