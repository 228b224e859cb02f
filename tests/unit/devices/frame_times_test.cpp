#include "topogeo/devices/frame_times.hpp"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kFrameUs_ns = 1000;
constexpr std::int64_t kFrameMs_ns = 1'000'000;
constexpr std::int64_t kStated_ns = 15 * kFrameMs_ns;

// Whatever the delays, times follow a rhythm that is 3 % slower than stated, within a millisecond a
// frame that is late.
TEST(FrameTimes, FollowASlowRhythmInSpiteOfDelays) {
  constexpr std::int64_t kTrue_ns = 15'500 * kFrameUs_ns;
  FrameTimes times(kStated_ns);
  support::Random random(3);
  std::int64_t worst_ns = 0;
  std::int64_t before_ns = -1;
  for (std::int64_t frame = 0; frame < 10'000; ++frame) {
    const std::int64_t true_ns = frame * kTrue_ns;
    const auto delay_ns = static_cast<std::int64_t>(random.below(4) == 0 ? random.below(9) : 0);
    const std::int64_t time_ns = times.next(0, true_ns + delay_ns * kFrameMs_ns);
    EXPECT_GT(time_ns, before_ns);
    before_ns = time_ns;
    if (frame > 10) worst_ns = std::max(worst_ns, std::abs(time_ns - true_ns));
  }
  EXPECT_LT(worst_ns, 10 * kFrameMs_ns);
}

TEST(FrameTimes, FramesOfOneReadingLieBehindEachOther) {
  FrameTimes times(kStated_ns);
  EXPECT_EQ(times.next(0, 0), 0);
  for (std::size_t behind = 10; behind-- > 0;) {
    const std::int64_t time_ns = times.next(behind, 150 * kFrameMs_ns);
    EXPECT_EQ(time_ns, 150 * kFrameMs_ns - static_cast<std::int64_t>(behind) * kStated_ns);
  }
}

TEST(FrameTimes, LostFramesAreAGap) {
  FrameTimes times(kStated_ns);
  EXPECT_EQ(times.next(0, 0), 0);
  EXPECT_EQ(times.next(0, 3000 * kFrameMs_ns), 3000 * kFrameMs_ns);
}

}  // namespace
}  // namespace topogeo::devices
