#include "topogeo/render/map_picture.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <gmock/gmock.h>

#include "canvas.hpp"
#include "pixels.hpp"
#include "sample_floor.hpp"

namespace topogeo::render {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(MapPicture, ShowsEveryPartInItsColour) {
  const SampleFloor floor = sample_floor();
  const Pixels pixels(map_png(floor.picture()));
  EXPECT_EQ(pixels.width(), 1600);
  EXPECT_GT(pixels.height(), 700);
  EXPECT_LT(pixels.height(), 1400);
  EXPECT_GT(pixels.count(kWhite), pixels.width() * pixels.height() / 2);
  EXPECT_GT(pixels.count(kLaserPoints), 4000);
  EXPECT_GT(pixels.count(kBranch), 200);
  EXPECT_GT(pixels.count(kVirtualBranch), 100);
  EXPECT_GT(pixels.count(kCorrected), 1000);
  EXPECT_GT(pixels.count(kOdometry), 500);
  EXPECT_GT(pixels.count(kDoor), 100);
  EXPECT_GT(pixels.count(kInk), 100);
}

TEST(MapPicture, DashesPartsWithoutAMatch) {
  const SampleFloor floor = sample_floor();
  MapPicture picture = floor.picture();
  picture.global_map = nullptr;  // virtual branches are dashed, too
  EXPECT_THAT(map_svg(picture), Not(HasSubstr("stroke-dasharray")));
  const auto whole = Pixels(map_png(picture)).count(kCorrected);
  std::vector<Eigen::Vector2d>& part = picture.unmatched_m.emplace_back();
  for (std::size_t i = 4; i < 12; ++i) {
    part.push_back(picture.stops[i].T_map_robot.position_m());
  }
  EXPECT_THAT(map_svg(picture), HasSubstr("stroke-dasharray"));
  EXPECT_LT(Pixels(map_png(picture)).count(kCorrected), whole);
}

TEST(MapPicture, DrawsNoLineToTheStartOfADrive) {
  std::vector<topomap::StampedPose> poses;
  for (int i = 0; i < 40; ++i) {
    const double gap_m = i < 20 ? 0.0 : 30.0;  // the second drive is elsewhere
    poses.push_back(
        {static_cast<std::uint64_t>(i), i * 1'000'000'000LL, {0.1 * i + gap_m, 0.0, 0.0}});
  }
  MapPicture picture;
  picture.corrected = poses;
  const int joined = Pixels(map_png(picture)).count(kCorrected);
  picture.drive_starts_ns = {poses[20].stamp_ns};
  const int apart = Pixels(map_png(picture)).count(kCorrected);
  EXPECT_LT(apart, joined / 2);
  EXPECT_GT(apart, 0);
}

TEST(MapPicture, ShowsTheWallsOfADrawnGrid) {
  MapPicture picture;
  for (int i = 0; i < 200; ++i) picture.walls_m.emplace_back(0.05 * i, 2.0);
  EXPECT_GT(Pixels(map_png(picture)).count(kLaserPoints), 500);
  EXPECT_THAT(map_svg(picture), Not(HasSubstr("nothing mapped yet")));
}

TEST(MapPicture, ShowsNamesPlacesAndZones) {
  MapPicture picture;
  for (int i = 0; i < 200; ++i) {
    picture.walls_m.emplace_back(0.05 * i, 0.0);
    picture.walls_m.emplace_back(0.05 * i, 5.0);
  }
  const auto box = [](double left_m) {
    return std::vector<Eigen::Vector2d>{
        {left_m, 1.0}, {left_m + 2.0, 1.0}, {left_m + 2.0, 3.0}, {left_m, 3.0}};
  };
  const std::string without = map_svg(picture);
  picture.zones = {{planning::ZoneKind::kNoGo, box(0.5)},
                   {planning::ZoneKind::kSlow, box(3.5)},
                   {planning::ZoneKind::kOneWay, box(6.5), 0.5}};
  picture.names = {{"kitchen", {5.0, 4.0}, true}, {"no-go 1", {1.5, 2.0}, false}};
  const Pixels pixels(map_png(picture));
  for (const Colour& colour : {kNoGoZone, kSlowZone, kOneWayZone}) {
    EXPECT_GT(pixels.count(colour), 300);
  }
  EXPECT_GT(pixels.count(kDoor), 20) << "the dot of the place";
  MapPicture nameless = picture;
  nameless.names.clear();
  EXPECT_GT(pixels.count(kInk), Pixels(map_png(nameless)).count(kInk));
  picture.zones.clear();
  picture.names.clear();
  EXPECT_EQ(map_svg(picture), without);
}

TEST(MapPicture, LeavesOutWhatIsNotThere) {
  const SampleFloor floor = sample_floor();
  MapPicture picture = floor.picture();
  picture.odometry = {};
  picture.global_map = nullptr;
  picture.loop_closures = {};
  const Pixels pixels(map_png(picture));
  for (const Colour& colour : {kOdometry, kBranch, kVirtualBranch, kDoor, kLoopClosure}) {
    EXPECT_EQ(pixels.count(colour), 0);
  }
  EXPECT_GT(pixels.count(kCorrected), 1000);
}

TEST(MapPicture, DrawsEmptyAndOneStopMaps) {
  MapPicture empty;
  empty.title = "Empty";
  const Pixels nothing(map_png(empty));
  EXPECT_EQ(nothing.count(kCorrected), 0);
  EXPECT_GT(nothing.count(kInk), 0);
  EXPECT_THAT(map_svg(empty), HasSubstr("</svg>"));

  topomap::LocalMap map;
  map.points = {{1.0F, 0.0F}, {1.0F, 0.1F}};
  const std::vector<topomap::LocalMap> maps{map};
  const std::vector<topomap::StopPose> stops(1);
  const std::vector<topomap::StampedPose> path(1);
  MapPicture one;
  one.local_maps = maps;
  one.stops = stops;
  one.corrected = path;
  one.odometry = path;
  EXPECT_GT(Pixels(map_png(one)).count(kLaserPoints), 0);
}

TEST(MapPicture, IsTheSameBytesEachTimeAndSmall) {
  const SampleFloor floor = sample_floor();
  const std::string svg = map_svg(floor.picture());
  EXPECT_THAT(svg.substr(0, 200), HasSubstr("<svg"));
  EXPECT_THAT(svg.substr(0, 300), HasSubstr("width=\"1600px\""));
  EXPECT_LT(svg.size(), 500000U);
  EXPECT_TRUE(map_svg(floor.picture()) == svg);
  EXPECT_TRUE(map_png(floor.picture()) == map_png(floor.picture()));
}

TEST(MapPicture, KeepsToTheWidthAndRefusesOddOnes) {
  const SampleFloor floor = sample_floor();
  EXPECT_EQ(Pixels(map_png(floor.picture(), {.max_width_px = 800})).width(), 800);
  EXPECT_THROW(map_png(floor.picture(), {.max_width_px = 399}), std::invalid_argument);
  EXPECT_THROW(map_svg(floor.picture(), {.max_width_px = 20000}), std::invalid_argument);
  MapPicture picture = floor.picture();
  picture.local_maps = picture.local_maps.first(3);
  EXPECT_THROW(map_png(picture), std::invalid_argument);
}

TEST(MapPicture, WritesFiles) {
  std::string name = std::string(::testing::TempDir()) + "/map_picture_XXXXXX";
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const std::filesystem::path directory(name);
  const SampleFloor floor = sample_floor();
  draw_map_png(directory / "map.png", floor.picture());
  draw_map_svg(directory / "map.svg", floor.picture());
  const auto start = [](const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {}).substr(0, 8);
  };
  EXPECT_EQ(start(directory / "map.png"), "\x89PNG\r\n\x1a\n");
  EXPECT_THAT(start(directory / "map.svg"), StartsWith("<?xml"));
  EXPECT_THROW(draw_map_png(directory / "no" / "map.png", floor.picture()), std::runtime_error);
  std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace topogeo::render
