#include "topogeo/render/scan_picture.hpp"

#include <numbers>
#include <numeric>
#include <stdexcept>

#include <gmock/gmock.h>

#include "pixels.hpp"
#include "sample_scan.hpp"
#include "scan_panels.hpp"

namespace topogeo::render {
namespace {

using ::testing::HasSubstr;

double mean_x(const std::vector<Eigen::Vector2d>& places) {
  return std::accumulate(places.begin(), places.end(), 0.0,
                         [](double sum, const Eigen::Vector2d& at) { return sum + at.x(); }) /
         static_cast<double>(places.size());
}

TEST(ScanPicture, ShowsTheWallsOnTheirSidesWithForwardUp) {
  const Pixels pixels(
      scan_picture(view_of(corridor_scan(true, true)), "hall", PictureFormat::kPng));
  ASSERT_EQ(pixels.width(), 1600);
  // Upper row: the polar plot on the left, the groups on the right. Group 0 is the right wall.
  const double half_px = 0.5 * pixels.height();
  for (const double left_px : {60.0, 860.0}) {
    const Rect panel{left_px, 92.0, 720.0, half_px - 200.0};
    const auto right_wall = pixels.find(group_colour(0), panel);
    const auto left_wall = pixels.find(group_colour(1), panel);
    ASSERT_GT(right_wall.size(), 100U);
    ASSERT_GT(left_wall.size(), 100U);
    EXPECT_LT(mean_x(left_wall) + 100.0, mean_x(right_wall));
  }
  // The robot faces up: it is below nearly all points of the plan, and between the walls.
  const Rect plan{860.0, 92.0, 720.0, half_px};
  const auto robot = pixels.find(kCorrected, plan);
  ASSERT_GT(robot.size(), 20U);
  const auto wall = pixels.find(group_colour(0), plan);
  const auto above = std::ranges::count_if(
      wall, [&](const Eigen::Vector2d& at) { return at.y() < robot.front().y(); });
  EXPECT_GT(above, static_cast<std::ptrdiff_t>(wall.size() * 3 / 4));
  EXPECT_LT(mean_x(robot), mean_x(wall));
}

TEST(ScanPicture, HasDiagramAndMapAndPalesWhatIsOffTheMainGraph) {
  ScanView view = view_of(corridor_scan(true, true));
  const Pixels main(scan_picture(view, "hall", PictureFormat::kPng));
  EXPECT_GT(main.count(kDiagramBranch), 500);
  EXPECT_GT(main.count(kBranch), 1000);
  for (topomap::LocalBranch& branch : view.map.branches) branch.in_main_graph = false;
  for (topomap::LocalNode& node : view.map.nodes) node.in_main_graph = false;
  const Pixels off(scan_picture(view, "hall", PictureFormat::kPng));
  EXPECT_LT(off.count(kBranch), main.count(kBranch) - 1000);
  EXPECT_EQ(off.count(kDiagramBranch), main.count(kDiagramBranch));
}

TEST(ScanPicture, ThinsBranchesThatAreNotConfirmed) {
  ScanView view = view_of(corridor_scan(true, true));
  for (topomap::LocalBranch& branch : view.map.branches) branch.confirmed = true;
  const int sure = Pixels(scan_picture(view, "hall", PictureFormat::kPng)).count(kBranch);
  for (topomap::LocalBranch& branch : view.map.branches) branch.confirmed = false;
  const int unsure = Pixels(scan_picture(view, "hall", PictureFormat::kPng)).count(kBranch);
  EXPECT_LT(unsure + 300, sure);
}

TEST(ScanPicture, MarksEveryKindOfNode) {
  ScanView view = view_of(corridor_scan(true, true));
  view.map.nodes.clear();
  view.map.branches.clear();
  const int doors = Pixels(scan_picture(view, "hall", PictureFormat::kPng)).count(kDoor);
  for (std::uint32_t i = 0; i < 6; ++i) {
    topomap::LocalNode node;
    node.id = i;
    node.kind = static_cast<topomap::NodeKind>(i);
    node.position_m = {1.0 + i, -0.25};
    view.map.nodes.push_back(node);
  }
  const Pixels pixels(scan_picture(view, "hall", PictureFormat::kPng));
  EXPECT_GT(pixels.count(kDoor), doors + 50);
  EXPECT_GT(pixels.count(kVirtualBranch), 10);
  EXPECT_GT(pixels.count(kOdometry), 20);
}

TEST(ScanPicture, DrawsVirtualDiagramsAndScansWithNothingInThem) {
  const Pixels wall(scan_picture(view_of(corridor_scan(true, false)), "hall", PictureFormat::kPng));
  EXPECT_GT(wall.count(kVirtualBranch), 200);
  // The local map at the lower right has only virtual branches.
  EXPECT_TRUE(wall.find(kBranch, {830.0, 0.5 * wall.height(), 770.0, 200.0}).empty());
  for (const std::size_t beams : {0U, 1U, 2U, 181U}) {
    EXPECT_THAT(scan_picture(view_of(blind_scan(beams)), "hall", PictureFormat::kSvg),
                HasSubstr("</svg>"))
        << beams;
  }
  voronoi::VoronoiConfig far;
  far.range_limit_m = 100.0;
  EXPECT_THAT(
      scan_picture(view_of(corridor_scan(true, true), {}, far), "hall", PictureFormat::kSvg),
      HasSubstr("</svg>"));
}

TEST(ScanPicture, FollowsTheMountingOfTheLaser) {
  // A laser that faces left has the same view as one that faces forward, turned to the left.
  const geometry::Pose2 left{0.2, 0.0, 0.5 * std::numbers::pi};
  const ScanView view = view_of(corridor_scan(true, true), left);
  const Extent extent = extent_of(view);
  EXPECT_GT(extent.max_m.y(), 9.0);
  EXPECT_LT(extent.max_m.x(), 3.0);
  const Pixels pixels(scan_picture(view, "hall", PictureFormat::kPng));
  EXPECT_GT(pixels.count(kDiagramBranch), 500);
}

TEST(ScanPicture, IsTheSameBytesEachTimeSmallAndOfTheWantedWidth) {
  const ScanView view = view_of(corridor_scan(true, true));
  const std::string svg = scan_picture(view, "hall", PictureFormat::kSvg);
  EXPECT_THAT(svg.substr(0, 300), HasSubstr("width=\"1600px\""));
  EXPECT_LT(svg.size(), 1'000'000U);
  EXPECT_TRUE(scan_picture(view, "hall", PictureFormat::kSvg) == svg);
  const auto width = [&](std::uint32_t px) {
    return Pixels(scan_picture(view, "hall", PictureFormat::kPng, {.max_width_px = px})).width();
  };
  EXPECT_EQ(width(400), 400);
  EXPECT_EQ(width(900), 900);
  EXPECT_THROW((void)width(399), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::render
