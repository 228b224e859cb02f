#include "server/controls.hpp"

#include <string>

#include <gmock/gmock.h>

#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ControlsTest : public testing::Test {
 protected:
  [[nodiscard]] std::string holder() const {
    return shown_["holder"].is_null() ? "" : shown_["holder"]["name"].get<std::string>();
  }
  [[nodiscard]] std::string asking() const {
    return shown_["asking"].is_null() ? "" : shown_["asking"]["name"].get<std::string>();
  }

  Json shown_;
  Controls controls_{[this](const std::string& json) { shown_ = Json::parse(json); }};
};

TEST_F(ControlsTest, TheFirstOrderTakesFreeControlsAndAnotherPageIsRefused) {
  EXPECT_EQ(controls_.enter(1, "secret a", "Anna"), 1U);
  EXPECT_EQ(controls_.enter(2, "secret b", "Ben"), 2U);
  EXPECT_EQ(holder(), "");
  EXPECT_TRUE(controls_.admit("secret a"));
  EXPECT_EQ(holder(), "Anna");
  EXPECT_EQ(shown_["holder"]["page"], 1);
  EXPECT_FALSE(controls_.admit("secret b"));
  EXPECT_FALSE(controls_.admit(2));
  EXPECT_TRUE(controls_.admit(1));
  EXPECT_THAT(controls_.refusal(), HasSubstr("Anna has the controls"));
  EXPECT_THAT(shown_.dump(), testing::Not(HasSubstr("secret"))) << "others must not use the id";
}

TEST_F(ControlsTest, ProgramsAreNotKeptFromOrdering) {
  controls_.enter(1, "a", "Anna");
  EXPECT_TRUE(controls_.admit("a"));
  EXPECT_TRUE(controls_.admit(std::string()));
  EXPECT_EQ(holder(), "Anna");
  EXPECT_EQ(controls_.name_of(""), "a program");
  EXPECT_EQ(controls_.enter(7, "", "Foxglove"), 0U);
  EXPECT_TRUE(controls_.admit(7));
}

TEST_F(ControlsTest, APageThatIsGoneHoldsNothing) {
  controls_.enter(1, "a", "Anna");
  controls_.enter(3, "a", "Anna");  // it connects again before the old connection ends
  controls_.enter(2, "b", "Ben");
  EXPECT_TRUE(controls_.admit("a"));
  controls_.leave(1);
  EXPECT_FALSE(controls_.admit("b"));
  controls_.leave(3);
  EXPECT_EQ(holder(), "");
  EXPECT_TRUE(controls_.admit("b"));
  EXPECT_EQ(holder(), "Ben");
  controls_.enter(4, "a", "Anna");
  EXPECT_FALSE(controls_.admit("a"));
}

TEST_F(ControlsTest, AnotherPageAsksAndTheHolderAnswers) {
  controls_.enter(1, "a", "Anna");
  controls_.enter(2, "b", "Ben");
  EXPECT_TRUE(controls_.admit("a"));
  controls_.ask("b");
  EXPECT_EQ(asking(), "Ben");
  controls_.answer("b", true);
  EXPECT_EQ(holder(), "Anna") << "only the holder answers";
  controls_.answer("a", false);
  EXPECT_EQ(asking(), "");
  EXPECT_EQ(holder(), "Anna");
  controls_.ask("b");
  controls_.answer("a", true);
  EXPECT_EQ(holder(), "Ben");
  EXPECT_FALSE(controls_.admit("a"));
  controls_.let_go("b");
  EXPECT_EQ(holder(), "");
}

TEST_F(ControlsTest, TakingOverReturnsTheConnectionsOfTheOther) {
  controls_.enter(1, "a", "Anna");
  controls_.enter(2, "b", "Ben");
  EXPECT_TRUE(controls_.admit("a"));
  EXPECT_THAT(controls_.take("unknown"), IsEmpty());
  EXPECT_THAT(controls_.take("b"), ElementsAre(1));
  EXPECT_EQ(holder(), "Ben");
  EXPECT_THAT(controls_.take("b"), IsEmpty());
}

TEST_F(ControlsTest, NamesAreShortAndCanBeChanged) {
  controls_.enter(1, "a", std::string(39, 'x') + "\xC3\xA4 and more");
  EXPECT_EQ(controls_.name_of("a"), std::string(39, 'x')) << "no half of a character";
  controls_.rename("a", "Anna");
  EXPECT_EQ(controls_.name_of("a"), "Anna");
  controls_.rename("a", "");
  EXPECT_EQ(controls_.name_of("a"), "an operator");
}

TEST_F(ControlsTest, WhoStoppedTheRobotShowsUntilTheRelease) {
  controls_.set_stopped_by("Ben");
  EXPECT_EQ(shown_["stopped_by"], "Ben");
  controls_.set_stopped_by("");
  EXPECT_EQ(shown_["stopped_by"], "");
}

}  // namespace
}  // namespace topogeo::web
