#include "topogeo/exchange/map_formats.hpp"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/exchange/map_export.hpp"

namespace topogeo::exchange {
namespace {

using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAreArray;

/// The names in the first column of the table of formats: "`svg`, `png`" has two.
std::vector<std::string> names_in_documentation() {
  std::ifstream page(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "docs/exchange.md");
  static const std::regex kRow(R"(^\|((?: `[a-z0-9]+`,?)+) \|.*)");
  static const std::regex kName("`([a-z0-9]+)`");
  std::vector<std::string> names;
  std::string line;
  while (std::getline(page, line)) {
    std::smatch row;
    if (!std::regex_match(line, row, kRow)) continue;
    const std::string column = row[1];
    for (std::sregex_iterator name(column.begin(), column.end(), kName), end; name != end; ++name) {
      names.push_back((*name)[1]);
    }
  }
  return names;
}

TEST(MapFormats, TheTableOfTheDocumentationHasEachWrittenFormat) {
  std::vector<std::string> names;
  for (const MapFormat& format : export_formats()) names.emplace_back(format.name);
  EXPECT_THAT(names_in_documentation(), UnorderedElementsAreArray(names));
}

TEST(MapFormats, ARowIsComplete) {
  std::set<std::string_view> endings;
  std::size_t files = 0;
  for (const MapFormat& format : export_formats()) {
    EXPECT_THAT(format.write_help, Not(IsEmpty())) << format.name;
    EXPECT_THAT(format.endings, Not(IsEmpty())) << format.name;
    endings.insert(format.endings.begin(), format.endings.end());
    files += format.endings.size();
  }
  EXPECT_EQ(endings.size(), files) << "two formats write files of the same name";
  for (const MapFormat& format : import_formats()) {
    EXPECT_THAT(format.read_help, Not(IsEmpty())) << format.name;
  }
}

TEST(MapFormats, AFormatIsFoundByItsName) {
  EXPECT_EQ(format_named(import_formats(), "lif").name, "lif");
  EXPECT_THROW(format_named(import_formats(), "rmf"), std::invalid_argument);  // only written
  EXPECT_THROW(export_map({}, "drawing", "map", {}), std::invalid_argument);   // only read
  EXPECT_THROW(export_map({}, "", "map", {}), std::invalid_argument);
}

TEST(MapFormats, AMissingFileIsNamed) {
  for (const MapFormat& format : import_formats()) {
    try {
      static_cast<void>(format.read("/no/such.file", {}));
      ADD_FAILURE() << format.name << " is read from nothing";
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("/no/such.file")) << format.name;
    }
  }
}

TEST(MapFormats, AnEmptyMapIsWrittenUnderTheChosenName) {
  for (const char* format : {"zones", "g2o"}) {
    const ExportedMap exported = export_map({}, format, "folder/map", {});
    ASSERT_EQ(exported.files.size(), 1U) << format;
    EXPECT_EQ(exported.files.front().path, "folder/map") << format;
    EXPECT_THAT(exported.files.front().bytes, Not(IsEmpty())) << format;
  }
}

TEST(MapFormats, AFormatIsRecognizedByContent) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "guess";
  std::filesystem::create_directories(folder);
  const auto guess = [&](const std::string& name, const std::string& content) {
    std::ofstream(folder / name) << content;
    return guess_import_format(folder / name).format;
  };
  EXPECT_EQ(guess("a.pgm", "P5\n1 1\n255\n0"), "pgm");
  EXPECT_EQ(guess("a.yaml", "image: a.pgm\nresolution: 0.05\n"), "pgm");
  EXPECT_EQ(guess("b.yaml", "zones:\n  - {name: ramp}\n"), "drawing");
  EXPECT_EQ(guess("b.world.yaml", "name: floor\n"), "drawing");
  EXPECT_EQ(guess("c.json", R"({"type": "FeatureCollection", "features": []})"), "geojson");
  EXPECT_EQ(guess("d.json", R"({"metaInformation": {}, "layouts": []})"), "lif");
  EXPECT_EQ(guess("e.json", R"({"zoneSet": {"zones": []}})"), "zones");
  EXPECT_EQ(guess("f.xml", "<?xml version=\"1.0\"?>\n<graphml/>"), "graphml");
  for (const char* text : {"", "levels: {}\n", "{}", "<svg/>", "[1, 2]", "a: b: c", "{\"a\""}) {
    EXPECT_THROW(guess("g.txt", text), std::runtime_error) << text;
  }
}

}  // namespace
}  // namespace topogeo::exchange
