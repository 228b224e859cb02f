// The table of `topogeo store merges`, without DDS.
#include "topogeo/store/merge_table.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace topogeo::cli {
namespace {

using localization::MergeProposal;

MergeProposal proposal(std::uint32_t number, MergeProposal::State state) {
  MergeProposal out;
  out.number = number;
  out.state = state;
  out.robot = "b";
  out.other_robot = "a";
  out.place.stop = {0x22, 37};
  out.place.other = {0x21, 5};
  out.T_other_own = {1.5, -2.25, std::numbers::pi / 2.0};
  out.confidence = 0.875;
  out.stops = 5;
  out.distance_m = 4.5;
  out.matches = 15;
  out.fitness = 0.625;
  out.contradicted = 0.125;
  return out;
}

TEST(MergeTable, IsCompleteWithAllThatTheLocalizerCounts) {
  MergeTable table;
  EXPECT_FALSE(table.has_localizer());
  table.put(proposal(1, MergeProposal::State::kOpen));
  EXPECT_FALSE(table.is_complete()) << "how many there are is not known";
  table.expect(2.0);
  EXPECT_TRUE(table.has_localizer());
  EXPECT_FALSE(table.is_complete());
  EXPECT_EQ(table.progress(), "1 of 2 proposals");
  table.put(proposal(1, MergeProposal::State::kAccepted));
  EXPECT_FALSE(table.is_complete()) << "the same one again";
  table.put(proposal(2, MergeProposal::State::kOpen));
  EXPECT_TRUE(table.is_complete());
  table.expect(3.0);
  EXPECT_FALSE(table.is_complete()) << "a new one is on its way";
}

TEST(MergeTable, OfALocalizerWithoutProposalsIsCompleteAndSaysSo) {
  MergeTable table;
  table.expect(0.0);
  EXPECT_TRUE(table.is_complete());
  EXPECT_EQ(table.text(), "no merge is proposed\n");
  EXPECT_EQ(table.json(), "[]\n");
}

TEST(MergeTable, ShowsEachProposalWithItsEvidence) {
  MergeTable table;
  table.put(proposal(2, MergeProposal::State::kRefused));
  table.put(proposal(1, MergeProposal::State::kOpen));
  const std::string evidence =
      ": stop 37 of b is where stop 5 of a was\n"
      "   its map lies at x 1.50 m, y -2.25 m, heading 90.0 degrees in the other\n"
      "   confidence 0.88: 5 stops over 4.5 m, 15 matches of fitness 0.62, 12 % of what they "
      "should show contradicts\n";
  EXPECT_EQ(table.text(), "1  open" + evidence + "2  refused" + evidence);
}

TEST(MergeTable, GivesProgramsAllFields) {
  MergeTable table;
  table.put(proposal(4, MergeProposal::State::kWithdrawn));
  const nlohmann::json rows = nlohmann::json::parse(table.json());
  ASSERT_EQ(rows.size(), 1U);
  const nlohmann::json expected = {{"number", 4},
                                   {"state", "withdrawn"},
                                   {"robot", "b"},
                                   {"other_robot", "a"},
                                   {"stop", 37},
                                   {"session", "0000000000000022"},
                                   {"other_stop", 5},
                                   {"other_session", "0000000000000021"},
                                   {"x_m", 1.5},
                                   {"y_m", -2.25},
                                   {"theta_rad", std::numbers::pi / 2.0},
                                   {"confidence", 0.875},
                                   {"stops", 5},
                                   {"distance_m", 4.5},
                                   {"matches", 15},
                                   {"fitness", 0.625},
                                   {"contradicted", 0.125}};
  EXPECT_EQ(rows[0], expected);
  MergeTable accepted;
  accepted.put(proposal(1, MergeProposal::State::kAccepted));
  EXPECT_EQ(nlohmann::json::parse(accepted.json())[0].at("state"), "accepted");
}

}  // namespace
}  // namespace topogeo::cli
