// Files and texts from elsewhere that demand too many resources.
#include "topogeo/support/foreign_file.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "topogeo/support/config_schema.hpp"
#include "topogeo/support/file_content.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/json_limits.hpp"
#include "topogeo/support/temporary_folder.hpp"
#include "topogeo/support/yaml_reader.hpp"

#include "hostile_files.hpp"

namespace topogeo::support {
namespace {

using test::refusal_of;
using testing::AllOf;
using testing::HasSubstr;

class ForeignFile : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path path(const std::string& name) const {
    return folder_.path() / name;
  }
  [[nodiscard]] std::filesystem::path written(const std::string& text) const {
    std::ofstream(path("file"), std::ios::binary) << text;
    return path("file");
  }

 private:
  TemporaryFolder folder_{"foreign_file"};
};

TEST_F(ForeignFile, IsReadUpToItsLimit) {
  const std::string text = std::string("a\0b", 3) + std::string(3'000'000, 'x');
  EXPECT_EQ(foreign_content(written(text), text.size()), text);
  EXPECT_EQ(foreign_content(written(""), 0), "");
  EXPECT_EQ(refusal_of([&] { static_cast<void>(foreign_content(written(text), 5)); }),
            path("file").string() + ": is 3000003 bytes, expected at most 5");
  EXPECT_EQ(first_bytes(written(text), 3), text.substr(0, 3));
  EXPECT_EQ(first_bytes(written("ab"), 3), "ab");
}

// Half a terabyte that takes no space on the disk, and must take none in memory.
TEST_F(ForeignFile, SizeIsCheckedBeforeMemoryIsTaken) {
  std::filesystem::resize_file(written("x"), 500'000'000'000);
  EXPECT_THAT(refusal_of([&] { static_cast<void>(file_content(path("file"))); }),
              HasSubstr("is 500000000000 bytes, expected at most 2000000000"));
}

TEST_F(ForeignFile, WithoutASizeIsReadToItsEnd) {
  EXPECT_THAT(foreign_content("/proc/self/status", 1'000'000), HasSubstr("Pid:"));
}

TEST_F(ForeignFile, NothingButRegularFilesAreOpened) {
  std::filesystem::create_directory(path("folder"));
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path("socket").string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ::close(socket);
  for (const test::IrregularFile& file : {test::IrregularFile{path("folder"), "a directory"},
                                          {path("socket"), "a socket"},
                                          {test::make_fifo(path("fifo")), "a FIFO"},
                                          {"/dev/zero", "a device"}}) {
    const auto is_named = AllOf(HasSubstr(file.path.string() + ": is " + file.kind),
                                HasSubstr("expected a regular file"));
    EXPECT_THAT(refusal_of([&] { static_cast<void>(foreign_content(file.path, 10)); }), is_named);
    EXPECT_THAT(refusal_of([&] { refuse_irregular(file.path); }), is_named);
    EXPECT_EQ(first_bytes(file.path, 10), "");
  }
  EXPECT_THAT(refusal_of([&] { static_cast<void>(foreign_content(path("none"), 10)); }),
              HasSubstr("none: cannot be opened: No such file or directory"));
  EXPECT_EQ(refusal_of([&] { refuse_irregular(path("none")); }), "");
}

TEST_F(ForeignFile, OfSettingsIsARegularOneAsWell) {
  ConfigSchema schema;
  EXPECT_THAT(refusal_of([&] { load_yaml_file(test::make_fifo(path("a.yaml")), schema); }),
              HasSubstr("a.yaml: is a FIFO"));
  EXPECT_THAT(refusal_of([&] { load_yaml_file(written(std::string(1 << 21, '#')), schema); }),
              HasSubstr("expected at most 1048576"));
}

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

std::string object_of_keys(std::size_t keys) {
  std::string text = "{";
  for (std::size_t i = 0; i < keys; ++i) {
    text += (i == 0 ? "\"k" : ",\"k") + std::to_string(i) + "\":0";
  }
  return text + "}";
}

TEST(JsonLimits, LevelsKeysAndValues) {
  EXPECT_EQ(beyond_limits(repeated("[", 100) + repeated("]", 100)), "");
  EXPECT_EQ(beyond_limits(repeated("[", 101) + repeated("]", 101)),
            "more than 100 levels of lists and objects");
  EXPECT_EQ(beyond_limits(repeated("{\"a\":[", 100'000)),
            "more than 100 levels of lists and objects")
      << "also without an end";
  EXPECT_EQ(beyond_limits("[" + object_of_keys(kMostKeys) + "," + object_of_keys(kMostKeys) + "]"),
            "");
  EXPECT_EQ(beyond_limits("[[" + object_of_keys(300'000) + "]]"),
            "more than 128 keys in one object");
  EXPECT_EQ(beyond_limits("[1,2,{\"a\":true}]", {.values = 6}), "");
  EXPECT_EQ(beyond_limits("[1,2,{\"a\":true}]", {.values = 5}), "more than 5 values");
}

TEST(JsonLimits, TextsThatAreNoJsonAreForTheParserToName) {
  for (const char* text : {"", "{", "]", "{\"a\"", "nonsense", "[1,]", "\xff"}) {
    EXPECT_EQ(beyond_limits(text), "") << text;
  }
}

std::string yaml_refusal(const std::string& text) {
  return refusal_of([&] { static_cast<void>(parse_yaml(text, "f", "all")); });
}

TEST(YamlLimits, Levels) {
  EXPECT_EQ(yaml_refusal(repeated("[", 100) + repeated("]", 100)), "");
  EXPECT_THAT(yaml_refusal(repeated("[", 101) + repeated("]", 101)),
              HasSubstr("f:1: more than 100 levels"));
  EXPECT_THAT(yaml_refusal(repeated("- ", 100'000)), HasSubstr("f:1: more than 100 levels"));
  EXPECT_THAT(yaml_refusal("a:\n  " + repeated("{b: ", 101)), HasSubstr("f:2: more than 100"));
}

TEST(YamlLimits, BytesAndValues) {
  EXPECT_EQ(yaml_refusal("# " + std::string(kMostYamlBytes, 'x')),
            "f:1: is 16000002 bytes, expected at most 16000000");
  EXPECT_THAT(yaml_refusal("[" + repeated("a,", kMostYamlValues) + "a]"),
              HasSubstr("f:1: more than 1000000 values"));
}

// Nine levels of nine aliases each expand to 400 million values.
TEST(YamlLimits, AliasesCountAsWhatTheyStandFor) {
  std::string text = "a0: &a0 [x, x]\n";
  for (int level = 1; level <= 9; ++level) {
    const std::string alias = fmt::format("*a{}", level - 1);
    text += fmt::format("a{0}: &a{0} [{1}{2}]\n", level, repeated(alias + ", ", 8), alias);
  }
  EXPECT_THAT(yaml_refusal(text), HasSubstr("more than 1000000 values, where an alias counts"));
  EXPECT_EQ(yaml_refusal("a: &a [1, 2]\nb: [*a, *a]\n"), "");
  EXPECT_THAT(yaml_refusal("&a [*a]"), HasSubstr("f:1: more than 100 levels"));
}

}  // namespace
}  // namespace topogeo::support
