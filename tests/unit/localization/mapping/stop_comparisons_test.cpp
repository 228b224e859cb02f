#include "stop_comparisons.hpp"

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using geometry::Pose2;

TEST(StopComparisons, APairIsWorthOneComparison) {
  StopComparisons comparisons;
  EXPECT_TRUE(comparisons.worth(2, 5, Pose2{}));
  comparisons.record(2, 5, Pose2{}, false);
  EXPECT_FALSE(comparisons.worth(2, 5, Pose2{}));
  EXPECT_TRUE(comparisons.worth(1, 5, Pose2{}));
  EXPECT_TRUE(comparisons.worth(2, 4, Pose2{}));
  EXPECT_TRUE(comparisons.worth(2, 6, Pose2{}));
}

TEST(StopComparisons, ARejectedPairIsWorthAnotherWhenThePredictionHasMoved) {
  StopComparisons comparisons;
  comparisons.record(0, 1, {1.0, 2.0, 3.1}, false);
  EXPECT_FALSE(comparisons.worth(0, 1, {1.29, 2.0, 3.1}));
  EXPECT_TRUE(comparisons.worth(0, 1, {1.31, 2.0, 3.1}));
  EXPECT_FALSE(comparisons.worth(0, 1, {1.0, 2.0, 3.14}));
  EXPECT_TRUE(comparisons.worth(0, 1, {1.0, 2.0, 3.04}));
  // Across the seam of the angle: 3.1 and -3.14 are 0.043 apart.
  EXPECT_FALSE(comparisons.worth(0, 1, {1.0, 2.0, -3.14}));
  EXPECT_TRUE(comparisons.worth(0, 1, {1.0, 2.0, -3.13}));
}

TEST(StopComparisons, AnAcceptedPairIsDoneUntilItIsForgotten) {
  StopComparisons comparisons;
  comparisons.record(0, 1, Pose2{}, true);
  EXPECT_FALSE(comparisons.worth(0, 1, {9.0, 9.0, 1.0}));
  comparisons.forget(0, 1);
  EXPECT_TRUE(comparisons.worth(0, 1, Pose2{}));
  comparisons.forget(0, 7);  // never compared: nothing to forget
}

}  // namespace
}  // namespace topogeo::localization
