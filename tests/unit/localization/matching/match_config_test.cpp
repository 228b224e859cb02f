#include "topogeo/matching/match_config.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "topogeo/calibration/odometry_calibration.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {
namespace {

using testing::StrEq;
using testing::ThrowsMessage;

TEST(LocalizationSettings, AValueOutsideItsRangeIsNamed) {
  LocalizerConfig localizer;
  EXPECT_NO_THROW(support::check_ranges(localizer));
  localizer.genetic.individuals = 3;
  EXPECT_THAT([&] { support::check_ranges(localizer); },
              ThrowsMessage<std::invalid_argument>(
                  StrEq("key 'match.individuals' = '3': expected whole number between 4 and "
                        "10000")));
  ScanTrackerConfig tracker;
  EXPECT_NO_THROW(support::check_ranges(tracker));
  tracker.smallest_overlap = 1.5;
  EXPECT_THAT([&] { support::check_ranges(tracker); },
              ThrowsMessage<std::invalid_argument>(StrEq(
                  "key 'tracker.smallest_overlap' = '1.5': expected number between 0 and 1")));
}

TEST(LocalizationSettings, CalibrationNamesTheKeysOfTheOdometry) {
  OdometryNoise noise;
  support::ConfigSchema schema;
  describe(noise, schema);
  ASSERT_EQ(schema.parameters().size(), kOdometryParameters.size());
  for (std::size_t i = 0; i < kOdometryParameters.size(); ++i) {
    const support::ConfigParameter& declared = schema.parameters()[i];
    EXPECT_EQ(declared.key, std::string("odometry.") + kOdometryParameters[i].key);
    EXPECT_EQ(declared.unit, kOdometryParameters[i].unit);
    noise.*kOdometryParameters[i].field = 0.5;
    EXPECT_EQ(declared.text(), "0.5");
  }
}

}  // namespace
}  // namespace topogeo::localization
