#include "topogeo/support/alike_lines.hpp"

#include <gmock/gmock.h>

namespace topogeo::support {
namespace {

using testing::ElementsAre;

TEST(AlikeLines, FewStayAsTheyAre) {
  const std::vector<std::string> lines = {
      "zone 'a': left out", "zone 'b': left out", "done",
      "zone 'c': left out", "zone 'd': left out", "zone 'e': left out"};
  EXPECT_EQ(merge_alike_lines(lines), lines);
}

TEST(AlikeLines, ManyAreOneLineWithTheirNumber) {
  std::vector<std::string> lines = {"LIF holds no clearance"};
  for (int i = 1; i <= 20'000; ++i) {
    lines.push_back("zones[" + std::to_string(i) + "]: zone 'p" + std::to_string(i) +
                    "' has no geometry");
  }
  lines.emplace_back("2 edges are left out");
  EXPECT_THAT(merge_alike_lines(lines),
              ElementsAre("LIF holds no clearance",
                          "zones[1]: zone 'p1' has no geometry (and 19999 more like this)",
                          "2 edges are left out"));
}

TEST(AlikeLines, OtherWordsMakeAnotherLine) {
  std::vector<std::string> lines;
  for (int i = 0; i < 6; ++i) {
    lines.push_back("scan " + std::to_string(i) + ": too long");
    lines.push_back("scan " + std::to_string(i) + ": too short");
  }
  EXPECT_THAT(merge_alike_lines(lines), ElementsAre("scan 0: too long (and 5 more like this)",
                                                    "scan 0: too short (and 5 more like this)"));
}

}  // namespace
}  // namespace topogeo::support
