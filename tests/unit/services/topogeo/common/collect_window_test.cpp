// Duration of collecting a table of services, on a simulated clock.
#include "topogeo/common/collect_window.hpp"

#include <gtest/gtest.h>

namespace topogeo::cli {
namespace {

/// End of a window of 3.2 s, polled every 0.1 s, when the services are first received at these
/// times.
double end_s(std::initializer_list<double> heard_s) {
  CollectWindow window(3.2);
  for (int tick = 1; tick < 100; ++tick) {
    const double waited_s = 0.1 * tick;
    std::size_t count = 0;
    for (const double heard : heard_s) count += heard <= waited_s + 1e-9 ? 1 : 0;
    if (!window.goes_on(waited_s, count)) return waited_s;
  }
  return 1000.0;
}

TEST(CollectWindow, EndsSoonWhereAllAreHeardAtOnce) {
  EXPECT_NEAR(end_s({0.2, 0.2, 0.3}), 1.2, 0.051);
}

TEST(CollectWindow, WaitsForThoseThatAreHeardLate) {
  EXPECT_NEAR(end_s({0.2, 1.0, 1.6}), 2.4, 0.151) << "a period without another one";
}

TEST(CollectWindow, WaitsForTheFirstOne) {
  EXPECT_NEAR(end_s({2.0}), 2.8, 0.151);
}

TEST(CollectWindow, EndsWhateverComes) {
  EXPECT_NEAR(end_s({}), 3.2, 0.051);
  EXPECT_NEAR(end_s({0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.1}), 3.2, 0.051);
}

}  // namespace
}  // namespace topogeo::cli
