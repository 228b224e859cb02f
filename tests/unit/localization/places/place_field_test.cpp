// Searching a whole map in parts gives what searching it at once gives, here and from its pieces.
#include "topogeo/localization/places/place_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/localization/matching/matcher.hpp"

namespace topogeo::localization {
namespace {

using testing::HasSubstr;
using Answers = std::vector<std::vector<PlaceSeed>>;

/// Walls of an L-shaped room, 5 cm apart.
//
//   4 +-----+
//     |     |
//   2 |     +-----+
//     |           |
//   0 +-----------+
//     0     3     6
std::vector<topomap::ScanPoint> walls() {
  std::vector<topomap::ScanPoint> points;
  const auto line = [&](float x0, float y0, float x1, float y1) {
    const int steps = static_cast<int>(20.0F * (std::abs(x1 - x0) + std::abs(y1 - y0)));
    for (int i = 0; i < steps; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(steps);
      points.push_back({x0 + t * (x1 - x0), y0 + t * (y1 - y0)});
    }
  };
  line(0, 0, 6, 0);
  line(6, 0, 6, 2);
  line(6, 2, 3, 2);
  line(3, 2, 3, 4);
  line(3, 4, 0, 4);
  line(0, 4, 0, 0);
  return points;
}

class PlaceFieldTest : public ::testing::Test {
 protected:
  PlaceFieldTest() {
    std::vector<std::uint8_t> free;
    for (int y = 0; y < field_.grid().rows(); ++y) {
      for (int x = 0; x < field_.grid().columns(); ++x) {
        const Eigen::Vector2d p = field_.grid().centre_m(x, y);
        const bool room = p.x() > 0.3 && p.x() < 5.7 && p.y() > 0.3 && p.y() < 1.7;
        const bool upper = p.x() > 0.3 && p.x() < 2.7 && p.y() > 0.3 && p.y() < 3.7;
        free.push_back(room || upper ? 1 : 0);
        if (room || upper) cells_.push_back(p);
      }
    }
    field_.set_free(free);
    // Every 25th point of the walls, as seen from the truth.
    const std::vector<topomap::ScanPoint> all = walls();
    const geometry::Pose2 T_robot_map = geometry::inverse(truth_);
    const geometry::SinCos r = geometry::sincos(T_robot_map.theta_rad);
    for (std::size_t i = 0; i < all.size(); i += 25) {
      const double x = all[i].x_m;
      const double y = all[i].y_m;
      seen_.emplace_back(T_robot_map.x_m + r.cos * x - r.sin * y,
                         T_robot_map.y_m + r.sin * x + r.cos * y);
    }
    questions_ = field_.questions(seen_);
  }

  [[nodiscard]] static Answers ask(
      const PlaceField& field, const std::vector<std::shared_ptr<const PlaceQuestion>>& questions) {
    Answers answers;
    for (const auto& question : questions) answers.push_back(field.answer(*question));
    return answers;
  }

  const geometry::Pose2 truth_{1.6, 2.4, 0.7};
  PlaceField field_{walls(), 7.0};
  std::vector<Eigen::Vector2d> cells_;  // free ones, in their order
  std::vector<Eigen::Vector2d> seen_;
  std::vector<std::shared_ptr<const PlaceQuestion>> questions_;
};

TEST_F(PlaceFieldTest, TheBestSeedIsWhereThePointsWereSeen) {
  const std::vector<PlaceSeed> seeds = best_of(ask(field_, questions_));
  ASSERT_FALSE(seeds.empty());
  const geometry::Pose2 best = field_.pose_of(seeds.front());
  EXPECT_LT((best.position_m() - truth_.position_m()).norm(), 0.3);
  EXPECT_LT(std::abs(geometry::wrap_angle(best.theta_rad - truth_.theta_rad)), 0.1);
}

// The oracle tries every cell in every heading by itself.
TEST_F(PlaceFieldTest, ThePartsTogetherAreTheSearchOfAllHeadings) {
  std::vector<PlaceSeed> all;
  for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
    for (std::uint32_t cell = 0; cell < cells_.size(); ++cell) {
      PlaceSeed best;
      for (std::uint32_t h = quarter * 18; h < (quarter + 1) * 18; ++h) {
        const geometry::SinCos r = geometry::sincos(2.0 * std::numbers::pi / 72 * h);
        int score = 0;
        for (const Eigen::Vector2d& p : seen_) {
          const double x = static_cast<float>(p.x());
          const double y = static_cast<float>(p.y());
          const double column = std::floor((r.cos * x - r.sin * y) / 0.25 + 0.5);
          const double row = std::floor((r.sin * x + r.cos * y) / 0.25 + 0.5);
          score +=
              field_.grid().at(cells_[cell].x() + 0.25 * column, cells_[cell].y() + 0.25 * row);
        }
        if (score > best.score) {
          best = {static_cast<std::uint16_t>(score), static_cast<std::uint16_t>(h), cell};
        }
      }
      if (best.score > 0) all.push_back(best);
    }
  }
  std::sort(all.begin(), all.end(), [](const PlaceSeed& a, const PlaceSeed& b) {
    return std::tie(b.score, a.cell, a.heading) < std::tie(a.score, b.cell, b.heading);
  });
  ASSERT_GT(all.size(), PlaceField::kSeeds);
  all.resize(PlaceField::kSeeds);
  EXPECT_EQ(best_of(ask(field_, questions_)), all);
}

TEST_F(PlaceFieldTest, ItsPiecesMakeTheSameField) {
  ASSERT_GE(field_.pieces().size(), 2U);
  const PlaceField copy(field_.pieces(), *questions_.front());
  EXPECT_EQ(copy.hash(), field_.hash());
  EXPECT_EQ(ask(copy, questions_), ask(field_, questions_));
}

TEST_F(PlaceFieldTest, PiecesOfAnotherFieldAreRefused) {
  const PlaceField other(walls(), 8.0);
  EXPECT_THROW(PlaceField(other.pieces(), *questions_.front()), std::invalid_argument);
  const std::span all(field_.pieces());
  EXPECT_THROW(PlaceField(all.first(all.size() - 1), *questions_.front()), std::invalid_argument);
  auto far = std::make_shared<topomap::LocalMap>(*field_.pieces().front());
  far->points.front().x_m = 1e30F;
  const std::vector<std::shared_ptr<const topomap::LocalMap>> wide{far, field_.pieces().back()};
  EXPECT_THROW(PlaceField(wide, *questions_.front()), std::invalid_argument);
  PlaceQuestion moved = *questions_.front();
  moved.wall_pieces = 0;
  EXPECT_THROW(PlaceField(all, moved), std::invalid_argument);
  moved.wall_pieces = 1000;
  EXPECT_THROW(PlaceField(all, moved), std::invalid_argument);
}

TEST_F(PlaceFieldTest, AQuestionAboutSomethingElseIsRefused) {
  const auto changed = [&](auto change) {
    PlaceQuestion question = *questions_.front();
    change(question);
    return question;
  };
  for (const PlaceQuestion& wrong :
       {changed([](auto& q) { ++q.field_hash; }), changed([](auto& q) { q.points.clear(); }),
        changed([](auto& q) { q.points.resize(65); }), changed([](auto& q) { q.headings = 0; }),
        changed([](auto& q) { q.headings = 19; }), changed([](auto& q) { q.first_heading = 72; }),
        changed([](auto& q) { q.first_heading = 17; })}) {
    EXPECT_THROW(static_cast<void>(field_.answer(wrong)), std::invalid_argument);
  }
  EXPECT_TRUE(field_.questions({}).empty());
}

TEST_F(PlaceFieldTest, AWrongAnswerIsNamed) {
  const PlaceQuestion& question = *questions_[1];
  const std::vector<PlaceSeed> right = field_.answer(question);
  ASSERT_GT(right.size(), 3U);
  EXPECT_EQ(field_.verify(question, right), "");
  const auto complaint = [&](auto change) {
    std::vector<PlaceSeed> seeds = right;
    change(seeds);
    return field_.verify(question, seeds);
  };
  EXPECT_THAT(complaint([](auto& s) { ++s[0].score; }), HasSubstr("the score of seed 1 is stated"));
  EXPECT_THAT(complaint([](auto& s) { std::swap(s[0], s[1]); }), HasSubstr("not in its order"));
  EXPECT_THAT(complaint([](auto& s) { s.insert(s.begin(), s[0]); }), HasSubstr("seed 2"));
  EXPECT_THAT(complaint([](auto& s) { s[1] = s[0], ++s[1].heading; }), HasSubstr("seed 2"));
  EXPECT_THAT(complaint([](auto& s) { s[0].heading = 0; }), HasSubstr("outside of the search"));
  EXPECT_THAT(complaint([](auto& s) { s[2].cell = 1'000'000; }), HasSubstr("seed 3 is outside"));
  EXPECT_THAT(complaint([](auto& s) { s.resize(301, s.back()); }), HasSubstr("301 seeds"));
}

TEST_F(PlaceFieldTest, PosesClimbToWhereThePointsWereSeen) {
  const auto question = field_.climbing_question(seen_);
  std::vector<geometry::Pose2> poses;
  for (const PlaceSeed& seed : best_of(ask(field_, questions_))) {
    poses.push_back(field_.pose_of(seed));
  }
  poses.resize(5);
  const std::vector<MatchSolution> climbed = field_.climb_from(*question, poses);
  ASSERT_EQ(climbed.size(), poses.size());
  EXPECT_LT((climbed[0].T_reference_query.position_m() - truth_.position_m()).norm(), 0.05);
  const PlaceField copy(field_.pieces(), *questions_.front());
  const std::vector<MatchSolution> again = copy.climb_from(*question, poses);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(again[i].T_reference_query, climbed[i].T_reference_query);
    EXPECT_EQ(again[i].fitness, climbed[i].fitness);
  }
  EXPECT_EQ(field_.verify(*question, poses, climbed), "");
  const auto complaint = [&](auto change) {
    std::vector<MatchSolution> wrong = climbed;
    change(wrong);
    return field_.verify(*question, poses, wrong);
  };
  EXPECT_THAT(complaint([](auto& c) { c.pop_back(); }), HasSubstr("4 of 5 poses climbed"));
  EXPECT_THAT(complaint([](auto& c) { c[1].fitness += 0.1; }), HasSubstr("the value of pose 2"));
  EXPECT_THAT(complaint([](auto& c) { c[2].T_reference_query.x_m += 3.0; }),
              HasSubstr("pose 3 is not near"));
  PlaceQuestion wrong = *question;
  wrong.points.resize(121);
  EXPECT_THROW(static_cast<void>(field_.climb_from(wrong, poses)), std::invalid_argument);
}

TEST_F(PlaceFieldTest, AMatcherAnswersWhenItKnowsTheField) {
  Matcher matcher;
  MatchTask task;
  task.task_id = 7;
  task.places = questions_.front();
  EXPECT_THROW(matcher.solve(task), std::out_of_range);
  matcher.add_field(std::make_shared<const PlaceField>(field_));
  const MatchResult result = matcher.solve(task);
  EXPECT_EQ(result.task_id, 7U);
  EXPECT_EQ(result.seeds, field_.answer(*task.places));
  EXPECT_EQ(matcher.verify(task, result), "");
  MatchResult wrong = result;
  ++wrong.seeds.front().score;
  EXPECT_NE(matcher.verify(task, wrong), "");
  task.places = field_.climbing_question(seen_);
  task.initial_individuals = {truth_};
  const MatchResult climbed = matcher.solve(task);
  EXPECT_EQ(climbed.solutions.size(), 1U);
  EXPECT_EQ(matcher.verify(task, climbed), "");
  task.initial_individuals.resize(39);
  EXPECT_THROW(matcher.solve(task), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
