#include "topogeo/support/config_schema.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>

namespace topogeo::support {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

enum class Form : std::uint8_t { kSimple, kCombined };

struct Values {
  double distance_m = 1.0;
  double tiny = 0.1;
  std::int32_t offset = -3;
  std::uint32_t individuals = 50;
  std::uint64_t seed = 1;
  bool refine = true;
  std::string frame = "map";
  Form form = Form::kCombined;

  friend bool operator==(const Values&, const Values&) = default;
};

ConfigSchema declare(Values& v) {
  ConfigSchema schema;
  schema.add("mapping.stop_distance_m", &v.distance_m, 0.1, 5.0, "m",
             "Distance between two stops.");
  schema.add("match.genetic.tiny", &v.tiny, 0.0, 1.0, "", "A number\nexplained on two lines.");
  schema.add("match.genetic.offset", &v.offset, -10, 10, "", "Signed.");
  schema.add("match.genetic.individuals", &v.individuals, 2, 1000, "", "Population.");
  schema.add("seed", &v.seed, 0, std::numeric_limits<std::uint64_t>::max(), "", "Of the run.");
  schema.add("match.refine", &v.refine, "Whether to refine.");
  schema.add("mapping.frame", &v.frame, "Name of the frame.");
  schema.add("match.form", &v.form, {{"simple", Form::kSimple}, {"combined", Form::kCombined}},
             "How to score.");
  schema.refuse_section("absent", "is not built into this program");
  return schema;
}

/// The error message for the text; "" if it is accepted.
std::string error_of(const std::string& text) {
  Values v;
  const ConfigSchema schema = declare(v);
  try {
    load_yaml_text(text, "robot.yaml", schema);
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(v, Values{}) << "a refused file changed a value";
    return error.what();
  }
  return "";
}

TEST(ConfigSchema, ReadsNestedAndDottedKeysAndLeavesTheOthers) {
  Values v;
  const ConfigSchema schema = declare(v);
  load_yaml_text(
      "mapping:\n  stop_distance_m: 0.25\n  frame: \"floor: 1 # east\"\n"
      "match: {genetic: {individuals: 80, offset: -7}, refine: false, form: simple}\n"
      "match.genetic.tiny: 1e-3\n"
      "seed: 18446744073709551615\n",
      "robot.yaml", schema);
  EXPECT_EQ(v.distance_m, 0.25);
  EXPECT_EQ(v.frame, "floor: 1 # east");
  EXPECT_EQ(v.individuals, 80U);
  EXPECT_EQ(v.offset, -7);
  EXPECT_EQ(v.tiny, 1e-3);
  EXPECT_FALSE(v.refine);
  EXPECT_EQ(v.form, Form::kSimple);
  EXPECT_EQ(v.seed, std::numeric_limits<std::uint64_t>::max());
}

TEST(ConfigSchema, TakesEmptyTextAndEmptySectionsAsDefaults) {
  EXPECT_EQ(error_of(""), "");
  EXPECT_EQ(error_of("# nothing\n"), "");
  EXPECT_EQ(error_of("mapping:\n  # stop_distance_m: 2\nseed: 1\n"), "");
}

TEST(ConfigSchema, NamesFileLineKeyValueAndRange) {
  EXPECT_THAT(error_of("seed: 3\nmapping:\n  stop_distance_m: 7\n"),
              StrEq("robot.yaml:3: key 'mapping.stop_distance_m' = '7': expected number between "
                    "0.1 and 5 m"));
}

TEST(ConfigSchema, RefusesWrongValues) {
  for (const char* value : {"nan", "inf", "0.09", "1,5", "five", "0x1", "1.0m", "\"1.0\"", "[1]",
                            "{a: 1}", "", "~", "--1", "++1", "1e999"}) {
    EXPECT_THAT(error_of("mapping:\n  stop_distance_m: " + std::string(value) + "\n"),
                HasSubstr("robot.yaml:2: key 'mapping.stop_distance_m'"))
        << value;
  }
  for (const char* value : {"1", "1001", "-5", "50.0", "4294967346", "1e2"}) {
    EXPECT_THAT(error_of("match.genetic.individuals: " + std::string(value)),
                HasSubstr("expected whole number between 2 and 1000"))
        << value;
  }
  EXPECT_THAT(error_of("seed: 18446744073709551616"), HasSubstr("whole number"));
  EXPECT_THAT(error_of("seed: -1"), HasSubstr("whole number"));
  EXPECT_THAT(error_of("match.refine: yes"), HasSubstr("= 'yes': expected true or false"));
  EXPECT_THAT(error_of("match.form: both"), HasSubstr("'both': expected one of simple, combined"));
}

TEST(ConfigSchema, RefusesUnknownAndRepeatedKeys) {
  EXPECT_THAT(error_of("mapping:\n  stop_distance: 1\n"),
              StrEq("robot.yaml:2: key 'mapping.stop_distance': unknown, expected one of "
                    "stop_distance_m, frame"));
  EXPECT_THAT(error_of("sed: 1\n"), HasSubstr("unknown, expected one of mapping, match, seed"));
  EXPECT_THAT(error_of("absent:\n  key: 1\n"),
              StrEq("robot.yaml:1: key 'absent' is not built into this program"));
  EXPECT_THAT(error_of("seed: 1\nseed: 2\n"), StrEq("robot.yaml:2: key 'seed': given twice"));
  EXPECT_THAT(error_of("mapping: {frame: a}\nmapping: {stop_distance_m: 1}\n"),
              HasSubstr(":2: key 'mapping': given twice"));
  EXPECT_THAT(error_of("mapping: {frame: a}\nmapping.frame: b\n"),
              HasSubstr("key 'mapping.frame': given twice"));
}

TEST(ConfigSchema, RefusesWhatIsNoConfiguration) {
  EXPECT_THAT(error_of("seed: 1\nmapping: [1, 2\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(error_of("- a\n- b\n"), HasSubstr("robot.yaml:1: expected sections"));
  EXPECT_THAT(error_of("mapping: 3\n"), HasSubstr("is a section"));
  EXPECT_THAT(error_of("seed: 1\n---\nseed: 2\n"), HasSubstr("2 YAML documents"));
  EXPECT_THAT(error_of("? [a]\n: 1\n"), HasSubstr("plain word"));
  EXPECT_THAT(error_of("mapping: &m {mapping: *m}\n"), HasSubstr("robot.yaml"));
  EXPECT_NE(error_of(std::string("\x7f\x45\x4c\x46\x00\x01", 6)), "");
  EXPECT_THAT(error_of("seed: \"a\\nb\"\n"), Not(HasSubstr("\n")));
}

TEST(ConfigSchema, RefusesFilesThatCannotBeRead) {
  Values v;
  const ConfigSchema schema = declare(v);
  EXPECT_THROW(load_yaml_file("/nonexistent/robot.yaml", schema), std::runtime_error);
  EXPECT_THROW(load_yaml_file("/tmp", schema), std::runtime_error);
  const auto path = std::filesystem::path(::testing::TempDir()) / "config_schema_test_big.yaml";
  std::ofstream(path) << std::string((1U << 20U) + 1, '#');
  EXPECT_THROW(load_yaml_file(path, schema), std::runtime_error);
  std::ofstream(path) << "seed: 9\n";
  load_yaml_file(path, schema);
  EXPECT_EQ(v.seed, 9U);
  std::filesystem::remove(path);
}

TEST(ConfigSchema, WritesAFileThatReadsBackToTheSameValues) {
  Values v;
  const ConfigSchema schema = declare(v);
  v = {0.30000000000000004, 1.0 / 3.0,    10, 999, 1234567890123456789ULL, false,
       "a \"b\"\\\n#",      Form::kSimple};
  std::ostringstream out;
  write_yaml(schema, out);
  EXPECT_THAT(out.str(), HasSubstr("# number between 0.1 and 5 m; default 1 m\n"
                                   "  stop_distance_m: 0.30000000000000004\n"));

  Values read;
  const ConfigSchema read_schema = declare(read);
  load_yaml_text(out.str(), "written.yaml", read_schema);
  EXPECT_EQ(read, v);
  EXPECT_EQ(effective(read_schema).fingerprint, effective(schema).fingerprint);
}

TEST(ConfigSchema, ListsWhatIsInForceAndTellsConfigurationsApart) {
  Values v;
  const ConfigSchema schema = declare(v);
  const EffectiveConfig before = effective(schema);
  ASSERT_EQ(before.values.size(), 8U);
  EXPECT_EQ(before.values[0],
            (std::pair<std::string, std::string>("mapping.stop_distance_m", "1")));
  EXPECT_EQ(before.values[1].second, "0.1");
  EXPECT_EQ(before.values[7].second, "combined");
  v.tiny = std::nextafter(v.tiny, 1.0);
  EXPECT_NE(effective(schema).fingerprint, before.fingerprint);
  v.tiny = 0.1;
  EXPECT_EQ(effective(schema).fingerprint, before.fingerprint);
}

/// A point of the plane, a row of two numbers.
struct PlanePoint {
  double x = 0.5;
  double y = -1.0;
};

ConfigSchema declare_point(PlanePoint& point) {
  ConfigSchema schema;
  schema.add_rows<PlanePoint>(
      "scene.point", &point,
      [](const PlanePoint& p) -> NumberRows {
        return {{p.x, p.y}};
      },
      [](const NumberRows& rows) -> std::optional<PlanePoint> {
        if (rows.size() != 1 || rows[0].size() != 2) return std::nullopt;
        return PlanePoint{rows[0][0], rows[0][1]};
      },
      "two numbers", "Where it is.");
  return schema;
}

TEST(ConfigSchema, TakesRowsOfNumbersOfTheExpectedForm) {
  PlanePoint point;
  const ConfigSchema schema = declare_point(point);
  EXPECT_EQ(schema.find("scene.point")->default_text, "0.5 -1");
  for (const char* good : {"\"2 .25\"", "2 .25", "' 2  +0.25 '", ">-\n    2\n    0.25"}) {
    point = {};
    load_yaml_text("scene:\n  point: " + std::string(good) + "\n", "robot.yaml", schema);
    EXPECT_EQ(point.x, 2.0) << good;
    EXPECT_EQ(point.y, 0.25) << good;
  }
  std::ostringstream out;
  write_yaml(schema, out);
  EXPECT_THAT(out.str(), HasSubstr("# two numbers; default \"0.5 -1\"\n  point: \"2 0.25\"\n"));
  for (const char* bad : {"2", "2 3 4", "2 3; 4 5", "2 3;", ";2 3", "\"\"", "2 nan", "2 inf",
                          "2, 3", "2 x", "[2, 3]"}) {
    EXPECT_THAT([&] { load_yaml_text("scene:\n  point: " + std::string(bad), "r.yaml", schema); },
                ThrowsMessage<std::runtime_error>(HasSubstr("expected two numbers")))
        << bad;
    EXPECT_EQ(point.x, 2.0) << "a refused file changed the value: " << bad;
  }
}

TEST(ConfigSchema, WritesRowsThatItReadsBack) {
  NumberRows rows{{0.1, 1.0 / 3.0, 1e-9}, {-2.0}};
  const NumberRows written = rows;
  ConfigSchema schema;
  schema.add_rows<NumberRows>(
      "rows", &rows, [](const NumberRows& r) { return r; },
      [](const NumberRows& r) { return std::optional(r); }, "rows", "Any rows.");
  const std::string text = schema.find("rows")->text();
  rows.clear();
  (*schema.find("rows")->parse(text))();
  EXPECT_EQ(rows, written);
}

void describe(Values& values, ConfigSchema& schema) {
  schema.add("mapping.stop_distance_m", &values.distance_m, 0.1, 5.0, "m", "Between two stops.");
  schema.add("match.form", &values.form, {{"simple", Form::kSimple}, {"combined", Form::kCombined}},
             "How to score.");
}

TEST(ConfigSchema, ChecksValuesInMemoryAgainstTheDeclaredRanges) {
  Values values;
  EXPECT_NO_THROW(check_ranges(values));
  values.distance_m = 7.0;
  EXPECT_THAT([&] { check_ranges(values); },
              ThrowsMessage<std::invalid_argument>(StrEq("key 'mapping.stop_distance_m' = '7': "
                                                         "expected number between 0.1 and 5 m")));
  values.distance_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(check_ranges(values), std::invalid_argument);
  values = {};
  values.form = static_cast<Form>(9);
  EXPECT_THROW(check_ranges(values), std::invalid_argument);
}

TEST(ConfigSchema, NamesValuesThatDoNotFitEachOther) {
  EXPECT_NO_THROW(require_at_least("a.most", 2.0, "a.least", 2.0));
  EXPECT_THAT([] { require_at_least("a.most", 1.0, "a.least", 2.0); },
              ThrowsMessage<std::invalid_argument>(
                  StrEq("key 'a.most' = '1': expected at least a.least = 2")));
  EXPECT_NO_THROW(require_between("a.b", 1.0, 1.0, 2.0, "m"));
  EXPECT_THAT([] { require_between("a.b", 2.5, 1.0, 2.0, "m"); },
              ThrowsMessage<std::invalid_argument>(
                  StrEq("key 'a.b' = '2.5': expected number between 1 and 2 m")));
  EXPECT_THROW(require_between("a.b", std::numeric_limits<double>::quiet_NaN(), 1.0, 2.0, ""),
               std::invalid_argument);
}

TEST(ConfigSchema, WritesATableForEachSection) {
  Values values;
  values.form = Form::kSimple;
  ConfigSchema schema;
  schema.add("match.refine", &values.refine, "Whether to | refine.");
  describe(values, schema);
  std::ostringstream out;
  write_markdown(schema, out);
  EXPECT_EQ(out.str(),
            "### `match`\n\n"
            "| key | default | expected | meaning |\n|---|---|---|---|\n"
            "| `refine` | `true` | true or false | Whether to \\| refine. |\n"
            "| `form` | `simple` | one of simple, combined | How to score. |\n\n"
            "### `mapping`\n\n"
            "| key | default | expected | meaning |\n|---|---|---|---|\n"
            "| `stop_distance_m` | `1` | number between 0.1 and 5 m | Between two stops. |\n");
}

TEST(ConfigSchema, FilesCannotChangeFixedParameters) {
  double share = 0.25;
  double length_m = 2.0;
  ConfigSchema schema;
  schema.add("map.share", &share, 0, 1, "", "share of the views");
  schema.add("map.length_m", &length_m, 0, 10, "m", "length of a branch");
  const std::uint64_t before = effective(schema).fingerprint;
  schema.fix({"map.share"});

  load_yaml_text("map: {share: 0.250, length_m: 3}", "f.yaml", schema);
  EXPECT_EQ(share, 0.25);
  EXPECT_EQ(length_m, 3.0);
  for (const char* text :
       {"map: {share: 0.3, length_m: 4}", "map: {share: 7}", "map: {share: x}"}) {
    try {
      load_yaml_text(text, "f.yaml", schema);
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("expected 0.25, because it is fixed")) << text;
    }
    EXPECT_EQ(share, 0.25);
    EXPECT_EQ(length_m, 3.0);
  }

  length_m = 2.0;
  const EffectiveConfig after = effective(schema);
  EXPECT_EQ(after.fingerprint, before);
  ASSERT_EQ(after.values.size(), 1U);
  EXPECT_EQ(after.values[0].first, "map.length_m");
  std::ostringstream lists;
  write_yaml(schema, lists);
  write_markdown(schema, lists);
  EXPECT_THAT(lists.str(), testing::Not(testing::HasSubstr("share")));
  EXPECT_THROW(schema.fix({"map.width_m"}), std::invalid_argument);
}

TEST(ConfigSchema, ASectionOfFixedParametersIsNotListed) {
  double share = 0.25;
  ConfigSchema schema;
  schema.add("map.share", &share, 0, 1, "", "share of the views");
  schema.fix({"map.share"});
  std::ostringstream lists;
  write_yaml(schema, lists);
  write_markdown(schema, lists);
  EXPECT_EQ(lists.str(), "");
}

TEST(ConfigSchema, RefusesDeclarationsThatContradictEachOther) {
  double x = 0.5;
  ConfigSchema schema;
  schema.add("a.b", &x, 0, 1, "", "");
  EXPECT_THROW(schema.add("a.b", &x, 0, 1, "", ""), std::invalid_argument);
  EXPECT_THROW(schema.add("a", &x, 0, 1, "", ""), std::invalid_argument);
  EXPECT_THROW(schema.add("a.b.c", &x, 0, 1, "", ""), std::invalid_argument);
  EXPECT_THROW(schema.add("c", &x, 0.6, 1, "", ""), std::invalid_argument);
  for (const char* key : {"", ".a", "a.", "a..b", "a b", "a:"}) {
    EXPECT_THROW(schema.add(key, &x, 0, 1, "", ""), std::invalid_argument) << key;
  }
  EXPECT_EQ(schema.parameters().size(), 1U);
}

TEST(ConfigSchema, ReadsRowsAsAListOfLists) {
  NumberRows rows;
  ConfigSchema schema;
  schema.add_rows<NumberRows>(
      "outline", &rows, [](const NumberRows& r) { return r; },
      [](const NumberRows& r) { return std::optional(r); }, "corners", "its outline, if any");
  load_yaml_text("outline: [[0.5, -1], [2, 3e-1]]", "f.yaml", schema);
  EXPECT_EQ(rows, (NumberRows{{0.5, -1.0}, {2.0, 0.3}}));
  load_yaml_text("outline: 1 2; 3 4", "f.yaml", schema);
  EXPECT_EQ(rows, (NumberRows{{1.0, 2.0}, {3.0, 4.0}}));
  load_yaml_text("outline: []", "f.yaml", schema);
  EXPECT_TRUE(rows.empty());
  EXPECT_THROW(load_yaml_text("outline: [[a, 1]]", "f.yaml", schema), std::runtime_error);
  EXPECT_THROW(load_yaml_text("outline: [1, 2]", "f.yaml", schema), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::support
