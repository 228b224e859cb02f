#include "map_store/loop_verdicts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/service/conversions.hpp"

namespace topogeo::map_store {
namespace {

using storage::LoopVerdict;
using testing::ElementsAre;
using testing::SizeIs;

constexpr messaging::Handle kFirst{{1}};
constexpr messaging::Handle kSecond{{2}};

localization::LoopDecision decision(std::uint32_t earlier, std::uint32_t later,
                                    localization::LoopOutcome outcome) {
  localization::LoopDecision made;
  made.step = later;
  made.earlier_id = earlier;
  made.later_id = later;
  made.outcome = outcome;
  made.reason = localization::Reason::kNone;
  made.fitness = 0.5;
  return made;
}

msg::LoopDecisions message_of(const std::vector<localization::LoopDecision>& decisions,
                              std::uint64_t numbered_since = 0) {
  msg::LoopDecisions message = service::to_segment(decisions, 0, "robot", 0, 0);
  message.numbered_since(numbered_since);
  return message;
}

std::vector<std::uint32_t> later_ids(const LoopVerdicts& verdicts) {
  std::vector<std::uint32_t> ids;
  for (const LoopVerdict& verdict : verdicts.all()) ids.push_back(verdict.later_id);
  return ids;
}

TEST(LoopVerdicts, KeepsThoseOfEarlierDrivesAndLocalizers) {
  LoopVerdict stored;
  stored.step = stored.later_id = 5;
  LoopVerdicts verdicts({stored}, 0);
  EXPECT_EQ(verdicts.changes(), 0U);
  verdicts.add(message_of({decision(0, 8, localization::LoopOutcome::kGate)}), kFirst);
  verdicts.add(message_of({decision(0, 8, localization::LoopOutcome::kGate),
                           decision(1, 9, localization::LoopOutcome::kAccepted)}),
               kFirst);
  EXPECT_THAT(later_ids(verdicts), ElementsAre(5, 8, 9));
  // A localizer that starts again counts its decisions from 0.
  verdicts.add(message_of({decision(1, 9, localization::LoopOutcome::kOutvoted)}), kSecond);
  EXPECT_THAT(later_ids(verdicts), ElementsAre(5, 8, 9));
  EXPECT_EQ(verdicts.all().back().outcome, LoopVerdict::Outcome::kOutvoted);
  EXPECT_EQ(verdicts.all().back().fitness, 0.5);
  EXPECT_EQ(verdicts.all().back().explanation, "outvoted");
  EXPECT_EQ(verdicts.changes(), 3U);
}

TEST(LoopVerdicts, ForgetsThemWhenTheStopsGetOtherNumbers) {
  LoopVerdicts verdicts({}, 3);
  verdicts.add(message_of({decision(0, 8, localization::LoopOutcome::kAccepted)}, 3), kFirst);
  verdicts.add(message_of({decision(0, 9, localization::LoopOutcome::kGate)}, 2), kFirst);
  EXPECT_THAT(verdicts.all(), SizeIs(1));
  verdicts.add(message_of({decision(1, 6, localization::LoopOutcome::kGate)}, 4), kFirst);
  EXPECT_THAT(later_ids(verdicts), ElementsAre(6)) << "the earlier ones named other stops";
  EXPECT_EQ(verdicts.numbered_since(), 4U);
}

TEST(LoopVerdicts, DropsTheOldestRejectedOfTooMany) {
  std::vector<LoopVerdict> many(LoopVerdicts::kMost + 2);
  for (std::uint32_t i = 0; i < many.size(); ++i) many[i].step = many[i].later_id = i;
  many.front().outcome = LoopVerdict::Outcome::kAccepted;
  const LoopVerdicts verdicts(many, 0);
  const std::vector<LoopVerdict> kept = verdicts.all();
  ASSERT_THAT(kept, SizeIs(LoopVerdicts::kMost));
  EXPECT_EQ(kept[0].later_id, 0U);
  EXPECT_EQ(kept[1].later_id, 3U);
  EXPECT_THAT(within(kept, 4), SizeIs(2));
}

}  // namespace
}  // namespace topogeo::map_store
