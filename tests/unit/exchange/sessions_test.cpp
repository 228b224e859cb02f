#include "topogeo/exchange/sessions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/exchange/inspect.hpp"
#include "topogeo/storage/map_file.hpp"

#include "sample_floor.hpp"
#include "sample_stops.hpp"

namespace topogeo::exchange {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kMonday = 0xaaULL;
constexpr std::uint64_t kTuesday = 0xbbULL;

/// Stops 0 to 2 of Monday, 3 and 4 of Tuesday and 5 of Monday again; a measurement with Tuesday has
/// pulled stop 5 half a metre away.
storage::MapDocument two_sessions() {
  storage::MapDocument document = sample_stops();
  const std::vector<std::uint64_t> sessions = {kMonday,  kMonday,  kMonday,
                                               kTuesday, kTuesday, kMonday};
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    document.local_maps[i].stop = {sessions[i], static_cast<std::uint32_t>(i)};
    document.trajectory.stops[i].stop = document.local_maps[i].stop;
    document.trajectory.stops[i].located = true;
  }
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
  document.trajectory.stops[5].T_map_robot = {5.5, 0.0, 0.0};
  document.edges = {{0, 1, {1.0, 0.0, 0.0}, covariance},
                    {1, 2, {1.0, 0.0, 0.0}, covariance},
                    {2, 3, {1.0, 0.0, 0.0}, covariance},
                    {2, 5, {3.0, 0.0, 0.0}, covariance},
                    {3, 5, {3.0, 0.0, 0.0}, covariance}};
  document.refused_merges = {{{kMonday, 0}, {kMonday, 2}}, {{kMonday, 1}, {kTuesday, 3}}};
  document.loop_closures = {{0, 3, {3.0, 0.0, 0.0}}, {2, 5, {3.0, 0.0, 0.0}}};
  return document;
}

TEST(Sessions, AreListedInTheOrderInWhichTheyCame) {
  const auto sessions = sessions_of(two_sessions());
  ASSERT_EQ(sessions.size(), 2U);
  EXPECT_EQ(sessions[0].session, kMonday);
  EXPECT_EQ(sessions[0].stops, 4U);
  EXPECT_EQ(sessions[1].first_stop, 3U);
  EXPECT_EQ(sessions[1].last_stamp_ns, 5'000'000'000);
}

TEST(Sessions, HaveNamesThatReadBack) {
  EXPECT_EQ(session_text(0xc0ffeeULL), "0000000000c0ffee");
  EXPECT_EQ(session_of_text("0000000000c0ffee"), 0xc0ffeeULL);
  EXPECT_EQ(session_of_text("c0ffee"), 0xc0ffeeULL);
  EXPECT_FALSE(session_of_text("monday"));
  EXPECT_FALSE(session_of_text(""));
}

TEST(Sessions, OneThatIsRemovedLeavesNoTrace) {
  const storage::MapDocument map = without_session(two_sessions(), kTuesday, {});
  ASSERT_EQ(map.local_maps.size(), 4U);
  EXPECT_EQ(map.local_maps[3].stop.number, 5U);
  EXPECT_TRUE(map.local_maps[3].starts_drive);
  ASSERT_EQ(map.loop_closures.size(), 1U);
  EXPECT_EQ(map.loop_closures[0].later_id, 3U);
  ASSERT_EQ(map.edges.size(), 3U);
  // The pose returns to the place that the other measurements give it.
  EXPECT_NEAR(map.trajectory.stops[3].T_map_robot.x_m, 5.0, 1e-3);
  EXPECT_EQ(map.trajectory.stops[0].T_map_robot, geometry::Pose2{});
  EXPECT_THAT(map.refused_merges,
              testing::ElementsAre(storage::RefusedMerge{{kMonday, 0}, {kMonday, 2}}));
  const std::string bytes = storage::map_file_bytes(map);
  EXPECT_EQ(sessions_of(storage::parse_map_file(bytes, "f")).size(), 1U);
}

TEST(Sessions, WithoutMeasurementsPosesStay) {
  storage::MapDocument document = two_sessions();
  document.edges.clear();
  const storage::MapDocument map = without_session(document, kTuesday, {});
  EXPECT_EQ(map.trajectory.stops[3].T_map_robot.x_m, 5.5);
}

TEST(Sessions, TheLastOneAndUnknownOnesAreRefused) {
  EXPECT_THAT(error_of([] { without_session(two_sessions(), 7, {}); }),
              HasSubstr("session 0000000000000007: expected one of several in the map, no stop"));
  const storage::MapDocument monday = without_session(two_sessions(), kTuesday, {});
  EXPECT_THAT(error_of([&] { without_session(monday, kMonday, {}); }), HasSubstr("all stops"));
}

}  // namespace
}  // namespace topogeo::exchange
