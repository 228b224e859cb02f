// Resources of this process, as the system reports them.
#include "topogeo/support/process_resources.hpp"

#include <fstream>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::support {
namespace {

TEST(ProcessResources, MemoryGrowsByWhatIsUsed) {
  const std::uint64_t before = resident_bytes();
  EXPECT_GT(before, 1'000'000U);
  constexpr std::size_t kMore = 64U << 20U;
  const std::vector<char> used(kMore, 'x');  // written, so that it is resident
  EXPECT_GT(resident_bytes(), before + kMore * 9 / 10);
  EXPECT_EQ(used.back(), 'x');
}

TEST(ProcessResources, CountsTheFilesThatAreOpen) {
  const std::uint64_t before = open_files();
  EXPECT_GT(before, 0U);
  const std::ifstream one("/proc/self/status");
  const std::ifstream two("/proc/self/status");
  EXPECT_EQ(open_files(), before + 2);
}

}  // namespace
}  // namespace topogeo::support
