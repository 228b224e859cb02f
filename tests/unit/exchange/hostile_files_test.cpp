// Malicious files that would keep an importer busy, fill its memory or crash it.
#include "hostile_files.hpp"

#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/exchange/geojson.hpp"
#include "topogeo/exchange/graphml.hpp"
#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/exchange/grid_map.hpp"
#include "topogeo/exchange/lif.hpp"
#include "topogeo/exchange/read_text.hpp"
#include "topogeo/exchange/repair.hpp"
#include "topogeo/exchange/zone_set.hpp"
#include "topogeo/planning/grid_file.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/world/world.hpp"

#include "nurbs.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

namespace fs = std::filesystem;
using test::refusal_of;
using testing::AllOf;
using testing::HasSubstr;

/// A file format: its reader, and a valid file.
struct Kind {
  std::string ending;
  std::function<void(const fs::path&)> read;
  std::string good;
};

std::string sample_geojson() {
  const storage::MapDrawing drawing = sample_drawing();
  const topomap::GlobalMap map = sample_graph();
  return geojson_text(map, drawing, route_network(map, drawing, nullptr, {}));
}

std::string sample_map_file() {
  storage::MapDocument document;
  document.robot_id = "robot";
  document.global_map = sample_graph();
  document.trajectory.version = document.global_map.version;
  document.drawing = sample_drawing();
  return storage::map_file_bytes(document);
}

constexpr const char* kGridYaml =
    "image: a.pgm\nresolution: 0.05\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

std::vector<Kind> kinds() {
  const auto parser = [](auto parse) {
    return
        [parse](const fs::path& path) { static_cast<void>(parse(read_text(path), path.string())); };
  };
  const ExportHeader header{"floor 1", "L1", "topogeo", "robot 1", 0};
  return {
      {".geojson", parser(parse_geojson), sample_geojson()},
      {".lif.json", parser(parse_lif), lif_text(sample_graph(), sample_drawing(), {}, header).text},
      {".zones.json", parser(parse_zone_set), zone_set_text(sample_drawing().zones, header)},
      {".graphml", parser(parse_graphml), graphml_text(sample_graph(), sample_drawing().places)},
      {".yaml", [](const fs::path& path) { static_cast<void>(read_grid_image(path)); }, kGridYaml},
      {".grid.yaml", [](const fs::path& path) { static_cast<void>(planning::read_grid(path)); },
       kGridYaml},
      {".world.yaml", [](const fs::path& path) { static_cast<void>(world::load_world(path)); },
       "name: a\nwalls:\n  - {from: [0, 0], to: [8, 0], doors: [{at: 2.5, width: 0.9}]}\n"},
      {".zones.yaml",
       [](const fs::path& path) { static_cast<void>(planning::read_zone_drawing(path)); },
       "zones:\n  - {name: hall, polygon: [[0, 0], [4, 0], [4, 3]]}\n"
       "places:\n  - {name: room A, at: [1.5, 2.0]}\n"},
      {".pb", [](const fs::path& path) { static_cast<void>(storage::read_map(path)); },
       sample_map_file()},
      {".broken.pb",
       [](const fs::path& path) {
         const StoredPieces pieces = pieces_of_map_file(read_map_bytes(path), path.string());
         static_cast<void>(assemble(pieces, {}, path.string()));
       },
       sample_map_file()},
      {".tum", [](const fs::path& path) { static_cast<void>(storage::read_trajectory_tum(path)); },
       "2.0 0.25 0.002 0.0 0.0 0.0 0.0 1.0\n"}};
}

class HostileFile : public ScratchTest {};

TEST_F(HostileFile, NoKindIsReadFromAFifoOrADevice) {
  for (const Kind& kind : kinds()) {
    for (const test::IrregularFile& file : test::irregular_files(directory_, kind.ending)) {
      EXPECT_THAT(refusal_of([&] { kind.read(file.path); }),
                  AllOf(HasSubstr(file.path.string()), HasSubstr("is " + file.kind)));
    }
  }
}

TEST_F(HostileFile, SizeIsCheckedBeforeMemoryIsTaken) {
  for (const Kind& kind : kinds()) {
    const fs::path path = write("large" + kind.ending, kind.good);
    fs::resize_file(path, 100'000'000'000);
    EXPECT_THAT(
        refusal_of([&] { kind.read(path); }),
        AllOf(HasSubstr(path.string()), HasSubstr("is 100000000000 bytes, expected at most")));
  }
}

TEST_F(HostileFile, NamesTheImageThatIsNone) {
  const std::string rest =
      "\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: "
      "0.196\n";
  test::make_fifo(directory_ / "fifo.png");
  for (const char* image : {"/dev/zero", "fifo.png", "."}) {
    const fs::path yaml = write("floor.yaml", "image: " + std::string(image) + rest);
    EXPECT_THAT(refusal_of([&] { read_grid_image(yaml); }), HasSubstr("expected a regular file"));
    EXPECT_THAT(refusal_of([&] { planning::read_grid(yaml); }),
                HasSubstr("expected a regular file"));
  }
}

TEST_F(HostileFile, DamageEndsInAnErrorOrAMap) {
  support::Random random(20261128);
  static_cast<void>(write("a.pgm", "P2 2 2 255 254 0 205 100"));
  for (const Kind& kind : kinds()) {
    ASSERT_EQ(refusal_of([&] { kind.read(write("good" + kind.ending, kind.good)); }), "");
    for (int i = 0; i < test::damaged_files(); ++i) {
      const fs::path path = write("bad" + kind.ending, test::with_damage(kind.good, random));
      static_cast<void>(refusal_of([&] { kind.read(path); }));
    }
  }
}

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  all.reserve(text.size() * count);
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

using ParseJson = std::function<void(const std::string&)>;

std::vector<ParseJson> json_parsers() {
  return {[](const std::string& text) { static_cast<void>(parse_geojson(text, "f")); },
          [](const std::string& text) { static_cast<void>(parse_lif(text, "f")); },
          [](const std::string& text) { static_cast<void>(parse_zone_set(text, "f")); }};
}

TEST(HostileJson, NestingIsRefused) {
  for (const ParseJson& parse : json_parsers()) {
    for (const char* start : {"[", "{\"features\":", "{\"layouts\":[", "{\"zones\":[["}) {
      EXPECT_EQ(refusal_of([&] { parse(repeated(start, 100'000)); }),
                "f: more than 100 levels of lists and objects");
    }
    const std::string deep = repeated("[", 90) + repeated("]", 90);
    EXPECT_THAT(refusal_of([&] { parse("{\"features\":" + deep + "}"); }), HasSubstr("f: "));
  }
}

TEST(HostileJson, ObjectsOfManyKeysAreRefused) {
  std::string text = R"({"features":[],"layouts":[],"zones":[])";
  for (int i = 0; i < 300'000; ++i) text += ",\"k" + std::to_string(i) + "\":0";
  for (const ParseJson& parse : json_parsers()) {
    EXPECT_EQ(refusal_of([&] { parse(text + "}"); }), "f: more than 128 keys in one object");
  }
}

TEST(HostileLif, ManyStationsAreRefused) {
  std::string stations;
  for (std::size_t i = 0; i <= storage::kMaxPlaces; ++i) {
    stations += (i == 0 ? "" : ",") + (R"({"stationId":"s)" + std::to_string(i)) +
                R"(","interactionNodeIds":["a"]})";
  }
  EXPECT_THAT(refusal_of([&] {
                parse_lif(R"({"layouts":[{"nodes":[{"nodeId":"a","nodePosition":{"x":0,"y":0}}],)"
                          R"("edges":[],"stations":[)" +
                              stations + "]}]}",
                          "f");
              }),
              HasSubstr("f: layouts[0].stations[4096]: expected at most 4096 stations"));
}

// Each point of a curve finds its span by bisection.
TEST(HostileLif, LongCurvesHaveTheSpansOfShortOnes) {
  Nurbs curve;
  curve.degree = 2;
  constexpr int kPoints = 50'000;
  for (int i = 0; i < kPoints; ++i) {
    curve.points.emplace_back(i, 1.0);
    curve.weights.push_back(1.0);
  }
  for (int i = 0; i < kPoints + 3; ++i) curve.knots.push_back(i);
  ASSERT_EQ(curve.fault(), "");
  EXPECT_EQ(curve.polyline().size(), 1U + 8U * (kPoints - 2));
  EXPECT_NEAR(curve.at(2.0).x(), 0.5, 1e-12);
  EXPECT_NEAR(curve.at(30'000.0).x(), 29'998.5, 1e-6);
  EXPECT_NEAR(curve.at(kPoints).x(), kPoints - 1.5, 1e-6) << "the last span holds its end";
}

TEST(HostileGraphml, LongAndDeepTextsAreRefused) {
  const auto refusal = [](const std::string& text) {
    return refusal_of([&] { static_cast<void>(parse_graphml(text, "f")); });
  };
  std::string keys;
  for (int i = 0; i < 200; ++i) keys += "<key id=\"k" + std::to_string(i) + "\"/>";
  EXPECT_EQ(refusal("<graphml>" + keys + "<graph/></graphml>"), "f: more than 128 keys");
  const std::string x_and_y = R"(<key id="x" for="node" attr.name="x"><default>0</default></key>)"
                              R"(<key id="y" for="node" attr.name="y"><default>0</default></key>)";
  std::string nodes;
  for (std::size_t i = 0; i <= support::kMostXmlElements; ++i) {
    nodes += "<node id=\"" + std::to_string(i) + "\"/>";
  }
  EXPECT_EQ(refusal("<graphml>" + x_and_y + "<graph>" + nodes + "</graph></graphml>"),
            "f: more than 200000 nodes and edges");
  EXPECT_THAT(refusal(std::string(support::kMostXmlBytes + 1, ' ')),
              HasSubstr("f: is 32000001 bytes, expected at most 32000000"));
  EXPECT_THAT(refusal(repeated("<a>", 100'000) + repeated("</a>", 100'000)),
              HasSubstr("f: expected an element graphml"));
}

TEST(HostileWorld, LongListsAreRefused) {
  const auto refusal = [](const std::string& text) {
    return refusal_of([&] { static_cast<void>(world::parse_world(text, "f")); });
  };
  EXPECT_THAT(refusal("segments: [" + repeated("[0, 0, 1, 1], ", 20'001) + "]"),
              HasSubstr("f:1: segments: expected at most 20000 entries, got 20001"));
  EXPECT_THAT(refusal("places: [" + repeated("{}, ", 20'001) + "]"),
              HasSubstr("f:1: places: expected at most 20000 entries"));
  EXPECT_THAT(
      refusal("walls: [{from: [0, 0], to: [9, 0], doors: [" + repeated("{}, ", 1'001) + "]}]"),
      HasSubstr("f:1: doors: expected at most 1000 entries"));
}

/// A PNG of 20,000 x 5,000 grey pixels: signature, header and no pixels.
std::string png_of_many_pixels() {
  constexpr std::string_view kBytes(
      "\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x4e\x20"
      "\x00\x00\x13\x88\x08\x00\x00\x00\x00\x71\x56\x02\x11\x00\x00\x00\x00\x49\x44\x41"
      "\x54\x35\xaf\x06\x1e\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82",
      57);
  return std::string(kBytes);
}

TEST_F(HostileFile, PicturesOfManyPixelsAreRefusedByTheirHeader) {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffU);
    return bytes;
  };
  const auto bmp = [&](std::uint32_t width, std::uint32_t height) {
    return "BM" + std::string(8, '\0') + number(54) + number(40) + number(width) + number(height) +
           std::string("\1\0\x18\0", 4) + std::string(24, '\0');
  };
  const fs::path yaml = write("floor.yaml", kGridYaml);
  const auto refusal = [&](const std::string& image) {
    static_cast<void>(write("a.pgm", image));
    return refusal_of([&] { read_grid_image(yaml); });
  };
  const auto too_many =
      AllOf(HasSubstr("a.pgm: 20000 x 5000 pixels"), HasSubstr("16000000 in all"));
  EXPECT_THAT(refusal(png_of_many_pixels()), too_many);
  EXPECT_THAT(refusal(bmp(20'000, 5'000)), too_many);
  EXPECT_THAT(refusal("P5 20000 5000 255 "), HasSubstr("a.pgm: has 100000000 pixels"));
  EXPECT_THAT(refusal(bmp(4'000, 4'000)), HasSubstr("a BMP image that is cut short"));
  EXPECT_THAT(refusal("P5 4000 4000 255 "), HasSubstr("cut short"));
}

TEST_F(HostileFile, APictureThatUnpacksToMoreThanItsPixelsIsRefused) {
  // 10 x 10 black pixels, and two megabytes that could unpack to two gigabytes.
  constexpr std::string_view kPng(
      "\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x0a"
      "\x00\x00\x00\x0a\x08\x00\x00\x00\x00\xa8\x59\x90\x61\x00\x00\x00\x0c\x49\x44\x41"
      "\x54\x78\xda\x63\x60\xa0\x27\x00\x00\x00\x6e\x00\x01\x76\xa0\xa9\xcf",
      57);
  static_cast<void>(write("a.pgm", std::string(kPng) + std::string(std::size_t{2} << 20U, '\0')));
  const fs::path yaml = write("floor.yaml", kGridYaml);
  EXPECT_THAT(refusal_of([&] { read_grid_image(yaml); }),
              HasSubstr("bytes for 10 x 10 pixels, expected at most 1050"));
}

TEST(HostileGrid, LargeDrawnFloorsAreRefused) {
  planning::GridFrame frame;
  frame.columns = 4000;
  frame.rows = 4000;
  EXPECT_EQ(refusal_of([&] { check_grid_size(frame); }), "");
  frame.rows = 4001;
  EXPECT_EQ(refusal_of([&] { check_grid_size(frame); }),
            "a grid of 4000 x 4001 cells, expected at most 16000000 in all");
}

// A floor of 30 m x 30 m with stops every 0.2 m would have some 20,000 of them.
TEST(HostileGrid, FloorsHaveSoManyStopsAlone) {
  planning::GridFrame frame;
  frame.columns = 300;
  frame.rows = 300;
  frame.resolution_m = 0.1;
  planning::OccupancyGrid grid(frame);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    grid.set(frame.cell_at(i), planning::CellState::kFree);
  }
  const planning::FreeSpace space(grid);
  GridMapSettings settings;
  settings.spacing_m = 0.2;
  settings.fixed_spacing = true;
  EXPECT_THAT(refusal_of([&] { static_cast<void>(map_of_grid(space, {}, {}, "plan", settings)); }),
              HasSubstr("room for more than 3000 stops that are 0.2 m apart"));
  settings.fixed_spacing = false;
  const storage::MapDocument map = map_of_grid(space, {}, {}, "plan", settings);
  EXPECT_LE(map.local_maps.size(), kMostGridStops);
  EXPECT_GT(map.local_maps.size(), kMostGridStops / 4);
}

}  // namespace
}  // namespace topogeo::exchange
