#include "topogeo/results/map_quality.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <gmock/gmock.h>

namespace topogeo::results {
namespace {

using ::testing::HasSubstr;
using Kind = storage::MapEdge::Kind;

constexpr std::uint32_t kStops = 20;

/// A straight drive of 19 m on which each stop matches up to two recent ones, except across the
/// step to `open` (0: none).
storage::MapDocument drive(std::uint32_t open, std::uint32_t matches = 2) {
  storage::MapDocument document;
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.01, 0.0004).asDiagonal();
  for (std::uint32_t id = 0; id < kStops; ++id) {
    topomap::LocalMap map;
    map.T_odom_robot = {1.0 * id, 0.0, 0.0};
    map.points = {{1.0F, 0.0F}};
    document.local_maps.push_back(map);
    topomap::StopPose stop;
    stop.T_map_robot = map.T_odom_robot;
    document.trajectory.stops.push_back(stop);
    if (id > 0) {
      document.edges.push_back({id - 1, id, {1.0, 0.0, 0.0}, covariance, Kind::kOdometry});
    }
    for (std::uint32_t back = 1; back <= std::min(id, matches); ++back) {
      if (id - back < open && open <= id) continue;
      document.edges.push_back(
          {id - back, id, {1.0 * back, 0.0, 0.0}, covariance, Kind::kSequential});
    }
  }
  return document;
}

storage::Report judged(const storage::MapDocument& document, std::uint64_t accepted,
                       bool laser_known = true) {
  storage::Report report;
  report.scans = 200;
  report.matches_tried = 40;
  report.matches_accepted = accepted;
  add_quality(report, document, {"drive.clf.gz", laser_known});
  return report;
}

TEST(MapQuality, AMapOfMatchedStepsIsGood) {
  const storage::Report report = judged(drive(0), 38);
  EXPECT_EQ(report.quality.grade, "good");
  EXPECT_EQ(quality_text(report), "quality: good\n");
  EXPECT_FALSE(is_unreliable(report));
}

TEST(MapQuality, AnOpenStepInTheMiddleMakesItPoorAndSaysWhere) {
  const storage::Report report = judged(drive(10), 34);
  EXPECT_EQ(report.quality.grade, "poor");
  const std::string text = quality_text(report);
  EXPECT_THAT(text, HasSubstr("1 of 19 steps (1.0 m of 19.0 m) rest on odometry alone"));
  EXPECT_THAT(text, HasSubstr("stops 9 to 10 at x 9.0 m, y 0.0 m: 1.0 m long, may be off 0.28 m"));
  EXPECT_THAT(text, HasSubstr("try: more stops: stop: {distance_m: 0.5}"));
}

TEST(MapQuality, AnOpenStepAtTheEndMovesLittle) {
  EXPECT_EQ(judged(drive(kStops - 1), 34).quality.grade, "fair");
}

TEST(MapQuality, StopsWithFewMatchesMakeItPoor) {
  EXPECT_EQ(judged(drive(0, 1), 10).quality.grade, "poor");
  // Fewer are expected if only one is compared.
  storage::Report report;
  report.matches_tried = report.matches_accepted = 19;
  add_quality(report, drive(0, 1), {"drive.clf.gz", true, 1});
  EXPECT_EQ(report.quality.grade, "good");
}

TEST(MapQuality, AnUnknownMountingIsCalibratedFirst) {
  storage::MapDocument document = drive(0);
  for (std::uint32_t id = 0; id < kStops; ++id) {
    document.trajectory.stops[id].T_map_robot = {0.98 * id, 0.2 * id, 0.0};
  }
  const storage::Report report = judged(document, 10, false);
  EXPECT_EQ(report.quality.grade, "poor");
  EXPECT_EQ(report.quality.advice, "topogeo calibrate-laser drive.clf.gz --out laser.yaml");
  EXPECT_EQ(judged(document, 10, true).quality.advice,
            "topogeo calibrate-odometry drive.clf.gz --out odometry.yaml");
  EXPECT_EQ(judged(document, 38, true).quality.grade, "fair");  // matches carry the map
}

TEST(MapQuality, ALongDriveWithoutMatchesIsUselessAShortOneIsNot) {
  storage::MapDocument document = drive(0, 0);
  EXPECT_TRUE(is_unreliable(judged(document, 0)));
  EXPECT_THAT(quality_text(judged(document, 0)), HasSubstr("no match was accepted over 19.0 m"));
  document.local_maps.resize(5);
  document.trajectory.stops.resize(5);
  std::erase_if(document.edges, [](const auto& edge) { return edge.later_id >= 5; });
  EXPECT_FALSE(is_unreliable(judged(document, 0)));
}

TEST(MapQuality, ARestartOfTheOdometryIsNoWay) {
  storage::MapDocument document = drive(0, 0);
  for (std::uint32_t id = 10; id < kStops; ++id) {
    document.local_maps[id].odometry_epoch = 1;
    document.local_maps[id].T_odom_robot = {500.0 + id, 0.0, 0.0};
  }
  EXPECT_THAT(quality_text(judged(document, 0)), HasSubstr("no match was accepted over 18.0 m"));
}

TEST(MapQuality, StopsThatAreNotInTheMapMakeItPoor) {
  storage::Report report;
  report.stops = 90;
  report.matches_tried = report.matches_accepted = 90;
  add_quality(report, drive(0), {"drive.clf.gz", true, 3, 10, {}});
  EXPECT_EQ(report.quality.grade, "poor");
  EXPECT_THAT(quality_text(report), HasSubstr("10 of 100 stops are not in the map"));
  add_quality(report, drive(0), {"drive.clf.gz", true, 3, 2, {}});
  EXPECT_EQ(report.quality.grade, "fair");
}

TEST(MapQuality, OdometryThatTheScansContradictNearlyEverywhereIsReplaced) {
  // A robot that drives straight on by its odometry turns on the spot by its scans.
  storage::MapDocument document = drive(0);
  for (std::uint32_t id = 1; id < kStops; ++id) {
    topomap::LocalMap& map = document.local_maps[id];
    map.T_previous_robot = {0.0, 0.0, 0.7};
    map.track = {{0, 0, document.local_maps[id - 1].T_odom_robot, {}, true},
                 {1, 1, map.T_odom_robot, map.T_previous_robot, true}};
    if (id != 5) continue;
    EXPECT_EQ(judged(document, 38).quality.grade, "good");
  }
  const storage::Report report = judged(document, 38);
  EXPECT_TRUE(is_unreliable(report));
  EXPECT_THAT(quality_text(report), HasSubstr("the scans contradict the odometry in 100 % of"));
  EXPECT_EQ(advised_remedy(report), Remedy::kLaserOdometry);
}

TEST(MapQuality, OdometryOfAnotherScaleIsReplaced) {
  // Where a step is long enough, the scans see twice of it; a wheel that spins has other ratios.
  const auto judge = [](double growth, double ratio = 2.0) {
    storage::MapDocument document = drive(0);
    for (std::uint32_t id = 2; id < 16; id += 3) {
      topomap::LocalMap& map = document.local_maps[id];
      map.T_previous_robot = {ratio, 0.0, 0.0};
      map.track = {{0, 0, document.local_maps[id - 1].T_odom_robot, {}, true},
                   {1, 1, map.T_odom_robot, map.T_previous_robot, true}};
      ratio *= growth;
    }
    return judged(document, 38);
  };
  EXPECT_THAT(quality_text(judge(1.0)), HasSubstr("2.00 m by the scans for each metre"));
  EXPECT_EQ(advised_remedy(judge(1.0)), Remedy::kLaserOdometry);
  EXPECT_EQ(judge(1.2).quality.grade, "good");
  // Odometry of the scans would be wrong as well.
  EXPECT_THAT(quality_text(judge(1.0, 3.28)), HasSubstr("probably in feet"));
  EXPECT_EQ(advised_remedy(judge(1.0, 3.28)), std::nullopt);
}

/// A map whose path is longer or shorter than by odometry.
storage::MapDocument stretched(double scale, double scale_at_end) {
  storage::MapDocument document = drive(0);
  double x_m = 0.0;
  for (std::uint32_t id = 0; id < kStops; ++id) {
    document.trajectory.stops[id].T_map_robot.x_m = x_m;
    x_m += id < kStops / 2 ? scale : scale_at_end;
  }
  return document;
}

TEST(MapQuality, RangesOfAnotherScaleLookLikeOdometryOfAnotherScale) {
  EXPECT_EQ(judged(stretched(1.03, 1.03), 38).quality.grade, "good");
  EXPECT_EQ(judged(stretched(1.08, 1.0), 38).quality.grade, "good") << "a floor that slips";
  const storage::Report long_ranges = judged(stretched(1.08, 1.07), 38);
  EXPECT_FALSE(is_unreliable(long_ranges)) << "most robots with such a ratio have wrong wheels";
  EXPECT_EQ(long_ranges.quality.grade, "fair") << "another map may be better";
  EXPECT_THAT(quality_text(long_ranges), HasSubstr("longer by the scans than by the odometry"));
  EXPECT_THAT(long_ranges.quality.advice, HasSubstr("scan: {range_scale: 0.929}"));
  EXPECT_EQ(advised_remedy(long_ranges), std::nullopt);
  EXPECT_THAT(judged(stretched(0.9, 0.9), 38).quality.advice, HasSubstr("range_scale: 1.11}"));
  storage::Report stated;
  stated.matches_tried = stated.matches_accepted = 40;
  add_quality(stated, stretched(1.08, 1.07), {"drive.clf.gz", true, 3, 0, {}, 0, true});
  EXPECT_EQ(stated.quality.grade, "good");
  storage::Report from_scans;
  from_scans.laser_odometry.emplace();
  from_scans.matches_tried = from_scans.matches_accepted = 40;
  add_quality(from_scans, stretched(1.08, 1.07), {"drive.clf.gz", true});
  EXPECT_EQ(from_scans.quality.grade, "good");
}

TEST(MapQuality, OdometryThatMostScansLackIsReplaced) {
  storage::Report report;
  report.scans = 100;
  report.matches_tried = report.matches_accepted = 40;
  report.skipped_lines = {{"no odometry at its time", 300}};
  const auto judge = [&](std::uint64_t without_odometry) {
    add_quality(report, drive(0), {"drive.clf.gz", true, 3, 0, {}, without_odometry});
  };
  judge(300);
  EXPECT_EQ(report.quality.grade, "poor");
  EXPECT_EQ(advised_remedy(report), Remedy::kLaserOdometry);
  EXPECT_FALSE(is_unreliable(report));  // what is mapped is right
  judge(0);
  EXPECT_EQ(report.quality.advice, "topogeo check-log drive.clf.gz");
}

TEST(MapQuality, AdviceNamesNoRemedyThatWasTried) {
  storage::Report report;
  report.matches_tried = report.matches_accepted = 40;
  const auto advised = [&](std::set<Remedy> tried) {
    add_quality(report, drive(10), {"drive.clf.gz", true, 3, 0, std::move(tried)});
    return advised_remedy(report);
  };
  EXPECT_EQ(advised({}), Remedy::kMoreStops);
  EXPECT_EQ(advised({Remedy::kMoreStops}), Remedy::kOdometryNoise);
  EXPECT_EQ(advised({Remedy::kMoreStops, Remedy::kOdometryNoise}), Remedy::kLaserOdometry);
  EXPECT_EQ(advised({Remedy::kMoreStops, Remedy::kOdometryNoise, Remedy::kLaserOdometry}),
            std::nullopt);
  EXPECT_EQ(report.quality.advice, "topogeo check-log drive.clf.gz");
}

TEST(MapQuality, OdometryWithWheelsThatSlipInPlacesIsReplaced) {
  // The odometry counts half as much again as the map from stop 8 to 11.
  storage::MapDocument document = drive(0);
  double ahead_m = 0.0;
  for (std::uint32_t id = 1; id < kStops; ++id) {
    if (id > 8 && id <= 11) ahead_m += 0.5;
    document.local_maps[id].T_odom_robot.x_m += ahead_m;
  }
  storage::Report report = judged(document, 38);
  EXPECT_EQ(report.quality.grade, "fair");
  EXPECT_EQ(advised_remedy(report), Remedy::kLaserOdometry);
  add_quality(report, document, {"drive.clf.gz", true, 3, 0, {Remedy::kLaserOdometry}});
  EXPECT_EQ(advised_remedy(report), std::nullopt);
  EXPECT_THAT(report.quality.advice, HasSubstr("calibrate-odometry"));
}

TEST(MapQuality, AGoodOrOtherwiseFairMapNeedsNoRemedy) {
  EXPECT_EQ(advised_remedy(judged(drive(0), 38)), std::nullopt);
  EXPECT_EQ(advised_remedy(judged(drive(kStops - 1), 34)), std::nullopt);
}

TEST(MapQuality, StopsWithoutAnEchoNeedNoMatch) {
  storage::MapDocument document = drive(0, 3);
  for (std::uint32_t id = 2; id < kStops; id += 3) document.local_maps[id].points.clear();
  std::erase_if(document.edges, [&](const storage::MapEdge& edge) {
    return edge.kind == Kind::kSequential && (document.local_maps[edge.later_id].points.empty() ||
                                              document.local_maps[edge.earlier_id].points.empty());
  });
  EXPECT_THAT(quality_text(judged(document, 38)), testing::Not(HasSubstr("a stop matches only")));
}

TEST(MapQuality, TheBetterMapHasMoreScansThenTheBetterGradeThenFewerOpenSteps) {
  const storage::Report good = judged(drive(0), 38);
  const storage::Report poor = judged(drive(10), 34);
  EXPECT_TRUE(is_better(good, poor));
  EXPECT_FALSE(is_better(poor, good));
  EXPECT_FALSE(is_better(poor, poor));
  storage::Report closed = poor;
  closed.quality.odometry_stretches.front().held_by_loop = true;
  EXPECT_TRUE(is_better(closed, poor));
  storage::Report short_one = good;
  short_one.scans = 150;
  EXPECT_TRUE(is_better(poor, short_one));
  EXPECT_FALSE(is_better(short_one, poor));
}

TEST(MapQuality, OfEquallyPoorMapsMoreAcceptedMatchesCountWithTheSameOdometry) {
  const storage::Report few = judged(drive(10), 20);
  storage::Report many = judged(drive(10), 30);
  EXPECT_TRUE(is_better(many, few));
  EXPECT_FALSE(is_better(few, many));
  EXPECT_FALSE(is_better(judged(drive(10), 24), few));
  many.laser_odometry.emplace();
  EXPECT_FALSE(is_better(many, few));
}

TEST(MapQuality, AMapWithoutEdgesIsNotAssessed) {
  storage::MapDocument document = drive(0);
  document.edges.clear();
  EXPECT_EQ(quality_text(judged(document, 38)), "");
}

}  // namespace
}  // namespace topogeo::results
