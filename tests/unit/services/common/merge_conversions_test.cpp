#include "topogeo/service/merge_conversions.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::service {
namespace {

TEST(MergeConversions, AProposalComesBackAsItWas) {
  localization::MergeProposal proposal;
  proposal.number = 4;
  proposal.state = localization::MergeProposal::State::kRefused;
  proposal.robot = "b";
  proposal.other_robot = "a";
  proposal.place.stop = {22, 37};
  proposal.place.other = {21, 5};
  proposal.T_other_own = {1.0, -2.0, 0.5};
  proposal.confidence = 0.75;
  proposal.stops = 5;
  proposal.distance_m = 4.5;
  proposal.matches = 15;
  proposal.fitness = 0.625;
  proposal.contradicted = 0.125;
  msg::MergeProposal message = to_msg(proposal, "floor", 42, 9);
  EXPECT_EQ(message.robot_id().to_string(), "floor");
  EXPECT_EQ(message.state(), msg::kMergeRefused);
  EXPECT_EQ(message.stamp_ns(), 42);
  EXPECT_EQ(message.sequence_number(), 9U);
  const localization::MergeProposal back = from_msg(message);
  EXPECT_EQ(back.number, 4U);
  EXPECT_EQ(back.state, proposal.state);
  EXPECT_EQ(back.robot, "b");
  EXPECT_EQ(back.other_robot, "a");
  EXPECT_EQ(back.place.stop, proposal.place.stop);
  EXPECT_EQ(back.place.other, proposal.place.other);
  EXPECT_EQ(back.T_other_own, proposal.T_other_own);
  EXPECT_EQ(back.confidence, 0.75);
  EXPECT_EQ(back.stops, 5U);
  EXPECT_EQ(back.distance_m, 4.5);
  EXPECT_EQ(back.matches, 15U);
  EXPECT_EQ(back.fitness, 0.625);
  EXPECT_EQ(back.contradicted, 0.125);
  message.fitness(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(from_msg(message), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::service
