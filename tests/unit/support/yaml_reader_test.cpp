#include "topogeo/support/yaml_reader.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

namespace topogeo::support {
namespace {

using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

YamlNode shelf(const std::string& text) {
  return parse_yaml(text, "shelf.yaml", "the shelf");
}

TEST(YamlReader, GivesTypedValuesInTheOrderOfTheFile) {
  const YamlNode root = shelf(
      "name: left\nwidth: 0.8\nopen: true\n"
      "books:\n  - {title: Walden, at: [1, 2.5]}\n  - {title: '12', at: [3, 4]}\n");
  EXPECT_EQ(root.at("name").text(), "left");
  EXPECT_EQ(root.at("width").number(0.0, 1.0, "m"), 0.8);
  EXPECT_TRUE(root.at("open").boolean());
  const std::vector<YamlNode> books = root.at("books").items("a book");
  ASSERT_EQ(books.size(), 2U);
  EXPECT_EQ(books[0].name(), "a book");
  EXPECT_EQ(books[1].line(), 6);
  EXPECT_EQ(books[0].required("at").tuple(2, "[x, y]")[1].number(0.0, 9.0, "m"), 2.5);
  EXPECT_TRUE(books[1].at("title").is_quoted());
  EXPECT_FALSE(books[0].at("title").is_quoted());
  const std::vector<YamlEntry> entries = root.entries();
  ASSERT_EQ(entries.size(), 4U);
  EXPECT_EQ(entries[3].key.text(), "books");
  EXPECT_EQ(entries[3].key.line(), 4);
  EXPECT_EQ(entries[3].value.line(), 5);
}

TEST(YamlReader, AnAbsentListIsEmptyAndAnAbsentValueKnowsItsMap) {
  const YamlNode root = shelf("\nname: x\nempty:\n");
  EXPECT_TRUE(root.at("books").items().empty());
  EXPECT_FALSE(root.at("books").exists());
  EXPECT_EQ(root.at("books").line(), 2);
  EXPECT_TRUE(root.at("empty").is_null());
  EXPECT_TRUE(root.at("empty").exists());
  EXPECT_TRUE(shelf("# nothing\n").is_null());
}

struct Wrong {
  const char* name;
  void (*read)();
  const char* message;
};

// Printed by the test runner instead of the bytes.
std::ostream& operator<<(std::ostream& out, const Wrong& wrong) {
  return out << wrong.name;
}

class WrongYaml : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongYaml, IsAnErrorWithFileLineAndKey) {
  EXPECT_THAT(GetParam().read, ThrowsMessage<std::runtime_error>(StrEq(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    YamlReader, WrongYaml,
    ::testing::Values(
        Wrong{"no_map",
              [] {
                shelf("- 1").allow_keys({"a", "b", "c"});
              },
              "shelf.yaml:1: the shelf: expected a map with the keys a, b and c, got a list of 1"},
        Wrong{"unknown_key",
              [] {
                shelf("a: 1\nd: 2").allow_keys({"a", "b"});
              },
              "shelf.yaml:2: the shelf: expected one of the keys a, b, got 'd'"},
        Wrong{"key_that_is_a_list", [] { shelf("? [1]\n: 2").allow_keys({"a"}); },
              "shelf.yaml:1: the shelf: expected one of the keys a, got a list of 1"},
        Wrong{"key_twice", [] { shelf("a: 1\na: 2").allow_keys({"a"}); },
              "shelf.yaml:2: the shelf: expected each key once, got 'a'"},
        Wrong{"missing", [] { (void)shelf("\na: 1").required("b"); },
              "shelf.yaml:2: b: expected a value, got nothing: key 'b' is missing"},
        Wrong{"value_of_a_scalar", [] { (void)shelf("7").at("b"); },
              "shelf.yaml:1: the shelf: expected a map with the key b, got '7'"},
        Wrong{"too_large", [] { (void)shelf("a: 7").at("a").number(0.0, 0.5, "m"); },
              "shelf.yaml:1: a: expected a number from 0 to 0.5 m, got '7'"},
        Wrong{"not_a_number", [] { (void)shelf("a: .nan").at("a").number(0.0, 1.0, ""); },
              "shelf.yaml:1: a: expected a number from 0 to 1, got '.nan'"},
        Wrong{"no_number", [] { (void)shelf("a: {b: 1}").at("a").number(0.0, 1.0, ""); },
              "shelf.yaml:1: a: expected a number from 0 to 1, got a map"},
        Wrong{"no_boolean", [] { (void)shelf("a: 2").at("a").boolean(); },
              "shelf.yaml:1: a: expected true or false, got '2'"},
        Wrong{"no_text", [] { (void)shelf("a:").at("a").text(); },
              "shelf.yaml:1: a: expected a text, got nothing"},
        Wrong{"no_list", [] { (void)shelf("a: 3").at("a").items(); },
              "shelf.yaml:1: a: expected a list, got '3'"},
        Wrong{"short_tuple", [] { (void)shelf("a: [3]").at("a").tuple(2, "[x, y]"); },
              "shelf.yaml:1: a: expected [x, y], got a list of 1"},
        Wrong{"renamed", [] { shelf("a: \"1\\n2\"").at("a").named("a of it").fail("a digit"); },
              "shelf.yaml:1: a of it: expected a digit, got '1?2'"},
        Wrong{"two_documents", [] { shelf("a: 1\n---\na: 2"); },
              "shelf.yaml:1: holds 2 YAML documents, expected one"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(YamlReader, NamesTheLineOfWhatIsNoYaml) {
  EXPECT_THAT([] { shelf("a: 1\nb: [2\n"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("shelf.yaml:3: not valid YAML: ")));
  EXPECT_THAT([] { shelf(std::string(6000, '[')); },
              ThrowsMessage<std::runtime_error>(HasSubstr("shelf.yaml:1: ")));
}

TEST(YamlReader, AWrittenScalarReadsBack) {
  EXPECT_EQ(yaml_scalar("a b.pgm"), "a b.pgm");
  for (const std::string text : {"a: b", "# x", "", "- y", "\"q\"", "two\nlines"}) {
    EXPECT_EQ(shelf("a: " + yaml_scalar(text)).at("a").text(), text);
  }
}

}  // namespace
}  // namespace topogeo::support
