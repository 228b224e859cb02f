#include "topogeo/render/scan_view.hpp"

#include <gmock/gmock.h>

#include "plan_frame.hpp"
#include "sample_scan.hpp"
#include "scan_caption.hpp"

namespace topogeo::render {
namespace {

using ::testing::HasSubstr;

TEST(ScanView, HoldsGroupsDiagramAndMapOfTheScan) {
  const ScanView view = view_of(corridor_scan(true, true));
  ASSERT_EQ(view.diagram.groups.groups.size(), 2U);
  EXPECT_FALSE(view.diagram.is_virtual);
  EXPECT_FALSE(view.map.branches.empty());
  EXPECT_EQ(view.map.sequence, 7U);
  EXPECT_EQ(view.free_range_m.size(), 361U);
  for (const topomap::LocalBranch& branch : view.map.branches) {
    for (const topomap::BranchPoint& point : branch.points) {
      EXPECT_NEAR(point.position_m.y(), -0.25, 0.05);
    }
  }
}

TEST(ScanView, CellsCoverTheVisibleCorridorAndAreSplitAtTheMiddle) {
  voronoi::VoronoiConfig config;
  config.range_limit_m = 6.0;
  const ScanView view = view_of(corridor_scan(true, true), {}, config);
  double area_m2 = 0.0;
  for (const CellRun& run : view.cells) {
    const Eigen::Vector2d size_m = run.max_m - run.min_m;
    EXPECT_NEAR(size_m.x(), view.voronoi.resolution_m, 1e-9);
    area_m2 += size_m.prod();
    // Group 0 is seen first, from the right.
    if (run.group == 0) {
      EXPECT_LE(run.max_m.y(), -0.25 + 0.051);
    } else {
      EXPECT_GE(run.min_m.y(), -0.25 - 0.051);
    }
  }
  EXPECT_NEAR(area_m2, 2.5 * 6.0, 1.0);
}

TEST(ScanView, NothingIsLostWithoutEchoesOrBeams) {
  for (const std::size_t beams : {0U, 1U, 2U, 361U}) {
    const ScanView view = view_of(blind_scan(beams));
    EXPECT_TRUE(view.diagram.is_virtual) << beams;
    EXPECT_TRUE(view.map.points.empty()) << beams;
  }
}

TEST(ScanCaption, SaysWhichScanAndWhatWasFound) {
  const ScanView view = view_of(corridor_scan(true, true));
  EXPECT_EQ(scan_title(view, "hall.clf"), "hall.clf   scan 7 (counted from 0)   stamp 12.345 s");
  EXPECT_THAT(scan_counts(view), HasSubstr("361 beams, 2 groups"));
  EXPECT_THAT(scan_counts(view), HasSubstr("range limit 10 m, cells 0.05 m"));
  EXPECT_THAT(scan_title(view_of(corridor_scan(true, false)), "hall.clf"), HasSubstr("VIRTUAL"));
}

TEST(ScanCaption, CountsNodesByKindAndBranches) {
  ScanView view = view_of(blind_scan(2));
  view.diagram.is_virtual = false;
  using topomap::NodeKind;
  for (const NodeKind kind : {NodeKind::kReal, NodeKind::kReal, NodeKind::kDoor,
                              NodeKind::kFictitious, NodeKind::kHallCorridor}) {
    view.map.nodes.push_back({});
    view.map.nodes.back().kind = kind;
  }
  view.map.branches.resize(2);
  view.map.branches[1].in_main_graph = false;
  EXPECT_THAT(scan_counts(view),
              HasSubstr("5 nodes (2 real, 1 door, 1 hall_corridor, 1 fictitious), 2 branches (1 "
                        "off the main graph)"));
  view.map.nodes.resize(1);
  view.map.branches.resize(1);
  EXPECT_THAT(scan_counts(view), HasSubstr("1 node (1 real), 1 branch;"));
}

TEST(Extent, TakesInPointsBranchesAndTheRobot) {
  ScanView view = view_of(blind_scan(2));
  view.diagram.groups = {};
  view.map = {};
  view.map.points = {{4.0F, 1.0F}, {3.0F, -2.0F}};
  const Extent extent = extent_of(view);
  EXPECT_NEAR(extent.min_m.x(), -0.35, 1e-6);
  EXPECT_NEAR(extent.max_m.x(), 4.35, 1e-6);
  EXPECT_NEAR(extent.min_m.y(), -2.35, 1e-6);
  EXPECT_NEAR(extent.max_m.y(), 1.35, 1e-6);
  view.map.points.clear();
  const Extent empty = extent_of(view);
  EXPECT_TRUE(empty.min_m.isApprox(Eigen::Vector2d(-1.0, -1.0)));
  EXPECT_TRUE(empty.max_m.isApprox(Eigen::Vector2d(1.0, 1.0)));
}

TEST(PlanFrame, HasForwardUpLeftToTheLeftAndOneScale) {
  const PlanFrame frame = fit({{0.0, -4.0}, {6.0, 2.0}}, {100.0, 50.0, 400.0, 300.0}, 1000.0);
  EXPECT_DOUBLE_EQ(frame.scale_px_per_m, 50.0);
  // The extent's middle (3, -1) is in the middle of the rectangle.
  EXPECT_TRUE(frame.to_px({3.0, -1.0}).isApprox(Eigen::Vector2d(300.0, 200.0)));
  EXPECT_TRUE(frame.to_px({5.0, -1.0}).isApprox(Eigen::Vector2d(300.0, 100.0)));
  EXPECT_TRUE(frame.to_px({3.0, 1.0}).isApprox(Eigen::Vector2d(200.0, 200.0)));
  EXPECT_TRUE(frame.min_m().isApprox(Eigen::Vector2d(0.0, -5.0)));
  EXPECT_DOUBLE_EQ(fit({{0, 0}, {1, 1}}, {0, 0, 500, 500}, 160.0).scale_px_per_m, 160.0);
}

}  // namespace
}  // namespace topogeo::render
