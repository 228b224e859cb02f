#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "orders/order_text.hpp"
#include "server/bounded_json.hpp"
#include "server/viewer_message.hpp"

namespace topogeo::web {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

TEST(ViewerMessage, HelloHasAllThatAPageHolds) {
  const ViewerMessage message = parse_viewer_message(
      R"({"op":"hello","token":"t","life":"l","have":{"graph":6,"unheard":1},
          "channels":["pose","unheard","map"]})");
  EXPECT_EQ(message.op, ViewerMessage::Op::kHello);
  EXPECT_EQ(message.token, "t");
  EXPECT_EQ(message.life, "l");
  EXPECT_THAT(message.have, ElementsAre(Pair(Channel::kGraph, 6)));
  EXPECT_FALSE(message.all_channels);
  EXPECT_THAT(message.channels, ElementsAre(Channel::kPose, Channel::kMap));
  EXPECT_TRUE(parse_viewer_message(R"({"op":"hello"})").all_channels);
}

TEST(ViewerMessage, DriveHasTwoNumbersAndATime) {
  const ViewerMessage message =
      parse_viewer_message(R"({"op":"drive","linear_mps":0.3,"angular_radps":-1,"page_ms":12.5})");
  EXPECT_EQ(message.linear_mps, 0.3);
  EXPECT_EQ(message.angular_radps, -1.0);
  EXPECT_EQ(message.page_ms, 12.5);
  EXPECT_THROW(parse_viewer_message(R"({"op":"drive","linear_mps":0.3,"angular_radps":-1})"),
               std::invalid_argument);
  EXPECT_THROW(parse_viewer_message(R"({"op":"drive","linear_mps":0.3,"page_ms":1})"),
               std::invalid_argument);
  EXPECT_THROW(
      parse_viewer_message(R"({"op":"drive","linear_mps":"a","angular_radps":0,"page_ms":1})"),
      std::invalid_argument);
  EXPECT_THROW(
      parse_viewer_message(R"({"op":"drive","linear_mps":1e999,"angular_radps":0,"page_ms":1})"),
      std::invalid_argument);
}

TEST(ViewerMessage, ObjectsOfManyKeysAreRefused) {
  const auto object = [](std::size_t keys) {
    std::string text = R"({"op":"ping")";
    for (std::size_t i = 1; i < keys; ++i) text += ",\"k" + std::to_string(i) + "\":0";
    return text + "}";
  };
  EXPECT_NO_THROW(parse_viewer_message(object(kMostKeys)));
  EXPECT_THROW(parse_viewer_message(object(kMostKeys + 1)), std::invalid_argument);
  EXPECT_NO_THROW(parse_bounded("[" + object(kMostKeys) + "," + object(kMostKeys) + "]"));
  EXPECT_TRUE(parse_bounded(R"({"a":)" + object(kMostKeys + 1) + "}").is_discarded());
}

TEST(ViewerMessage, DeepTextsAreRefused) {
  const auto nested = [](std::size_t levels) {
    return std::string(levels, '[') + std::string(levels, ']');
  };
  EXPECT_FALSE(parse_bounded(nested(kMostLevels)).is_discarded());
  EXPECT_TRUE(parse_bounded(nested(kMostLevels + 1)).is_discarded());
}

TEST(ViewerMessage, WhatIsNoneIsNamed) {
  for (const char* text : {"", "nonsense", "[1]", "17", "{", R"({"op":7})", R"({"op":"fly"})",
                           R"({"op":"resync"})", R"({"op":"resync","channel":"none"})",
                           R"({"op":"channels"})", R"({"op":"channels","channels":[1]})",
                           R"({"op":"hello","have":[1]})", R"({"op":"hello","have":{"graph":-1}})",
                           R"({"op":"hello","token":1})", "{\"op\":\"\xff\"}"}) {
    EXPECT_THROW(parse_viewer_message(text), std::invalid_argument) << text;
  }
}

TEST(OrderText, GoalsArePlacesAndPoints) {
  const GoalOrders one = parse_goals(R"({"place":"room A","heading_rad":1.5})");
  ASSERT_EQ(one.goals.size(), 1U);
  EXPECT_EQ(one.goals[0].name, "room A");
  EXPECT_EQ(one.goals[0].heading_rad, 1.5);
  EXPECT_FALSE(one.append);
  const GoalOrders many =
      parse_goals(R"({"goals":[{"x_m":1,"y_m":-2.5},{"place":"b"}],"append":true})");
  ASSERT_EQ(many.goals.size(), 2U);
  EXPECT_EQ(*many.goals[0].point_m, Eigen::Vector2d(1.0, -2.5));
  EXPECT_TRUE(many.append);
  EXPECT_EQ(describe(many.goals[0]), "1.00, -2.50");
  EXPECT_EQ(many.rounds, 1U);
}

TEST(OrderText, GoalsHaveTimesToStayAndRounds) {
  const GoalOrders round =
      parse_goals(R"({"goals":[{"place":"a","wait_s":30},{"place":"b"}],"repeat":3})");
  EXPECT_EQ(round.goals[0].wait_s, 30.0);
  EXPECT_EQ(round.goals[1].wait_s, 0.0);
  EXPECT_EQ(round.rounds, 3U);
  EXPECT_EQ(parse_goals(R"({"goals":[{"place":"a"},{"place":"b"}],"repeat":0})").rounds, 0U);
  for (const char* wrong :
       {R"({"place":"a","repeat":2})", R"({"goals":[{"place":"a"}],"repeat":2})",
        R"({"goals":[{"place":"a"},{"place":"b"}],"repeat":2,"append":true})",
        R"({"goals":[{"place":"a"},{"place":"b"}],"repeat":-1})"}) {
    EXPECT_THAT([&] { parse_goals(wrong); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("repeat")))
        << wrong;
  }
  EXPECT_THAT([] { parse_goals(R"({"place":"a","wait_s":-1})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("wait_s")));
}

TEST(OrderText, AlarmsAreNumbers) {
  EXPECT_EQ(parse_alarm_numbers(R"({"acknowledge":[3,1]})"), (std::vector<std::uint64_t>{3, 1}));
  for (const char* wrong : {"{}", R"({"acknowledge":[]})", R"({"acknowledge":["1"]})",
                            R"({"acknowledge":[-1]})", R"({"acknowledge":1})"}) {
    EXPECT_THAT([&] { static_cast<void>(parse_alarm_numbers(wrong)); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("acknowledge")))
        << wrong;
  }
}

TEST(OrderText, WhatCannotBeIsNamed) {
  EXPECT_THAT([] { parse_goals(R"({"x_m":1})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("y_m")));
  EXPECT_THAT([] { parse_goals(R"({"place":""})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("place")));
  EXPECT_THAT([] { parse_goals(R"({"goals":[]})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("goals")));
  EXPECT_THAT([] { parse_goals(R"({"x_m":1e9,"y_m":0})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("x_m")));
  EXPECT_THAT([] { parse_pose_order(R"({"x_m":1,"y_m":0})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("theta_rad")));
  EXPECT_THAT([] { parse_merge_order(R"({"number":1})"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("accept")));
  EXPECT_THAT([] { static_cast<void>(parse_mapping_mode(R"({"mode":"other"})")); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("mode")));
  EXPECT_THROW(check_plain("[]"), std::invalid_argument);
  check_plain("");
  check_plain("{}");
}

TEST(OrderText, OtherOrders) {
  const PoseOrder pose = parse_pose_order(R"({"x_m":1,"y_m":2,"theta_rad":-3,"sigma_m":0.5})");
  EXPECT_EQ(pose.T_map_robot.y_m, 2.0);
  EXPECT_EQ(pose.sigma_m, 0.5);
  EXPECT_EQ(pose.sigma_rad, std::nullopt);
  EXPECT_TRUE(parse_merge_order(R"({"number":3,"accept":true})").accept);
  EXPECT_FALSE(parse_mapping_mode(R"({"mode":"localization"})"));
}

}  // namespace
}  // namespace topogeo::web
