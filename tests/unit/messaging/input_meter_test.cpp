// Rates and ages of an input at given times.
#include "topogeo/messaging/input_meter.hpp"

#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const InputMeter::Time kStart{std::chrono::hours(1)};

TEST(InputMeter, IsZeroBeforeTheFirst) {
  const InputMeter meter;
  EXPECT_EQ(meter.total(), 0U);
  EXPECT_EQ(meter.rate_per_s(kStart), 0.0);
  EXPECT_EQ(meter.age_s(kStart), 0.0);
}

TEST(InputMeter, GivesTheRateOfASteadyInput) {
  InputMeter meter;
  InputMeter::Time now = kStart;
  for (int i = 0; i < 1'000; ++i) meter.count(now += milliseconds(20));
  EXPECT_EQ(meter.total(), 1'000U);
  EXPECT_NEAR(meter.rate_per_s(now), 50.0, 2.0);
  EXPECT_EQ(meter.age_s(now + milliseconds(300)), 0.3);
}

TEST(InputMeter, DoesNotExaggerateTheFirstInputs) {
  InputMeter meter;
  for (int i = 0; i < 4; ++i) meter.count(kStart + milliseconds(i));
  EXPECT_EQ(meter.rate_per_s(kStart + milliseconds(5)), 4.0);
  EXPECT_EQ(meter.rate_per_s(kStart + seconds(2)), 2.0);
}

TEST(InputMeter, ForgetsAnInputThatHasCeased) {
  InputMeter meter;
  InputMeter::Time now = kStart;
  for (int i = 0; i < 100; ++i) meter.count(now += milliseconds(100));
  const double before = meter.rate_per_s(now);
  const double later = meter.rate_per_s(now + milliseconds(2'500));
  EXPECT_LT(later, before);
  EXPECT_GT(later, 0.0);
  EXPECT_EQ(meter.rate_per_s(now + InputMeter::kWindow + milliseconds(200)), 0.0);
  EXPECT_EQ(meter.age_s(now + seconds(60)), 60.0);
}

}  // namespace
}  // namespace topogeo::messaging
