#include "topogeo/session/slam_session.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using Use = MapToUse::Use;

// A drive through the room, and a session's map of it.
class SlamSessionTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    driven_ = new test::DrivenMaps(test::drive(test::world("room"), {}));
    InProcessPool pool;
    SlamSession session({}, pool);
    for (const auto& map : driven_->maps) session->add(map);
    session->finish();
    auto stored = std::make_shared<StoredMap>();
    for (const auto& map : session.mapping_session()->maps()) stored->maps.push_back(*map);
    stored->trajectory = session->trajectory();
    stored->loop_closures = session->loop_closures();
    stored_ = stored;
  }
  static void TearDownTestSuite() {
    stored_.reset();
    delete driven_;
    driven_ = nullptr;
  }

  static test::DrivenMaps* driven_;
  static std::shared_ptr<const StoredMap> stored_;
  InProcessPool pool_;
};

test::DrivenMaps* SlamSessionTest::driven_ = nullptr;
std::shared_ptr<const StoredMap> SlamSessionTest::stored_;

TEST_F(SlamSessionTest, ANewMapGrowsAndHasNoTracker) {
  SlamSession session({}, pool_);
  ASSERT_NE(session.mapping_session(), nullptr);
  EXPECT_EQ(session.map_tracker(), nullptr);
  EXPECT_TRUE(session.mapping());
  session->add(driven_->maps[0]);
  EXPECT_EQ(session.mapping_session()->maps().size(), 1U);
  session.mapping_session()->stop_mapping();
  EXPECT_FALSE(session.mapping());
  EXPECT_NE(session.map_tracker(), nullptr);
}

TEST_F(SlamSessionTest, LocalizingNeverMapsAndStartsAtTheGivenPose) {
  SlamSession session({}, pool_, nullptr, {stored_, Use::kLocalize, Pose2{}});
  EXPECT_EQ(session.mapping_session(), nullptr);
  ASSERT_NE(session.map_tracker(), nullptr);
  EXPECT_FALSE(session.mapping());
  session->add(driven_->maps[0]);
  EXPECT_EQ(session->status().state, LocalizationState::kTracking);
  EXPECT_LT(session->last_stop()->T_map_robot.position_m().norm(), 0.1);
  EXPECT_EQ(session->trajectory().stops.size(), 1U);
}

TEST_F(SlamSessionTest, WithoutAPoseItSearches) {
  const SlamSession session({}, pool_, nullptr, {stored_, Use::kLocalize, std::nullopt});
  session->add(driven_->maps[0]);
  EXPECT_NE(session->status().state, LocalizationState::kTracking);
}

TEST_F(SlamSessionTest, ContinuingExtendsTheStoredMap) {
  SlamSession session({}, pool_, nullptr, {stored_, Use::kExtendMap, Pose2{}});
  ASSERT_NE(session.mapping_session(), nullptr);
  EXPECT_TRUE(session.mapping());
  EXPECT_NE(session.map_tracker(), nullptr);
  for (std::size_t i = 0; i < 3; ++i) session->add(driven_->maps[i]);
  EXPECT_EQ(session.mapping_session()->stored_stops(), stored_->maps.size());
  EXPECT_EQ(session.mapping_session()->maps().size(), stored_->maps.size() + 3);
  EXPECT_EQ(session.map_tracker(), nullptr);
}

TEST_F(SlamSessionTest, RefusesAMapWithoutStops) {
  const auto empty = std::make_shared<const StoredMap>();
  EXPECT_THROW(SlamSession({}, pool_, nullptr, {empty, Use::kLocalize, std::nullopt}),
               std::invalid_argument);
  EXPECT_THROW(SlamSession({}, pool_, nullptr, {empty, Use::kExtendMap, std::nullopt}),
               std::invalid_argument);
}

TEST(GivenPose, IsKnownToThirtyCentimetresAndTenDegrees) {
  const Eigen::Matrix3d covariance = given_pose_covariance();
  EXPECT_DOUBLE_EQ(std::sqrt(covariance(0, 0)), 0.3);
  EXPECT_DOUBLE_EQ(std::sqrt(covariance(1, 1)), 0.3);
  EXPECT_DOUBLE_EQ(std::sqrt(covariance(2, 2)), std::numbers::pi / 18.0);
  EXPECT_EQ(covariance(0, 1), 0.0);
}

}  // namespace
}  // namespace topogeo::localization
