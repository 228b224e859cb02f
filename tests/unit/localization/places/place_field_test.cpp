// Found places are the true ones for any searcher; searches in pieces give the same results.
#include "topogeo/matching/place_field.hpp"

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
#include "topogeo/matching/matcher.hpp"

namespace topogeo::localization {
namespace {

using testing::HasSubstr;
using Answers = std::vector<std::vector<MatchSolution>>;

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

  [[nodiscard]] static std::vector<Eigen::Vector2d> points(const PlaceQuestion& question) {
    std::vector<Eigen::Vector2d> out;
    for (const topomap::ScanPoint& p : question.points) out.emplace_back(p.x_m, p.y_m);
    return out;
  }

  const geometry::Pose2 truth_{1.6, 2.4, 0.7};
  PlaceField field_{walls(), 7.0};
  std::vector<Eigen::Vector2d> cells_;  // free ones, in their order
  std::vector<Eigen::Vector2d> seen_;
  std::vector<std::shared_ptr<const PlaceQuestion>> questions_;
};

TEST_F(PlaceFieldTest, TheBestPlaceIsWhereThePointsWereSeen) {
  MatchSolution best;
  for (const auto& places : ask(field_, questions_)) {
    for (const MatchSolution& place : places) {
      if (place.fitness > best.fitness) best = place;
    }
  }
  EXPECT_LT((best.T_reference_query.position_m() - truth_.position_m()).norm(), 0.05);
  EXPECT_LT(std::abs(geometry::wrap_angle(best.T_reference_query.theta_rad - truth_.theta_rad)),
            0.02);
}

TEST_F(PlaceFieldTest, ThePartsTogetherSearchAllHeadings) {
  std::uint32_t first = 0;
  for (const auto& question : questions_) {
    EXPECT_EQ(question->first_heading, first);
    first += question->headings;
  }
  EXPECT_EQ(first, PlaceField::kHeadings);
}

// The oracle tries every cell with every heading separately, and takes the best one and those that
// do not touch a better one until there are enough.
TEST_F(PlaceFieldTest, PosesClimbFromTheBestCellsThatDoNotTouch) {
  struct Start {
    int score = 0;
    std::size_t cell = 0;
    std::uint32_t heading = 0;
  };
  for (const auto& question : questions_) {
    std::vector<Start> all;
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
      Start best;
      for (std::uint32_t i = 0; i < question->headings; ++i) {
        const std::uint32_t h = question->first_heading + i;
        const geometry::SinCos r = geometry::sincos(2.0 * std::numbers::pi / 72 * h);
        int score = 0;
        for (const topomap::ScanPoint& p : question->points) {
          const double x = p.x_m;
          const double y = p.y_m;
          const double column = std::floor((r.cos * x - r.sin * y) / 0.25 + 0.5);
          const double row = std::floor((r.sin * x + r.cos * y) / 0.25 + 0.5);
          score +=
              field_.grid().at(cells_[cell].x() + 0.25 * column, cells_[cell].y() + 0.25 * row);
        }
        if (score > best.score) best = {score, cell, h};
      }
      if (best.score > 0) all.push_back(best);
    }
    std::vector<MatchSolution> expected;
    const std::size_t wanted = 38 * question->headings / 9;
    while (expected.size() < wanted && !all.empty()) {
      const Start best =
          *std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
            return std::tie(b.score, a.cell) < std::tie(a.score, b.cell);
          });
      const Eigen::Vector2d at = cells_[best.cell];
      const Climbed place =
          climb(field_.fine(), points(*question),
                {at.x(), at.y(), geometry::wrap_angle(2.0 * std::numbers::pi / 72 * best.heading)});
      expected.push_back({place.T_map_robot, place.value});
      std::erase_if(all, [&](const Start& start) {
        return (cells_[start.cell] - at).lpNorm<Eigen::Infinity>() < 0.3;
      });
    }
    EXPECT_EQ(field_.answer(*question), expected);
  }
}

TEST_F(PlaceFieldTest, OfManyPointsEachSecondSearchesAndAllClimb) {
  PlaceQuestion many = *questions_.front();
  many.points.clear();
  for (std::size_t i = 0; i < 128; ++i) {
    many.points.push_back(questions_.front()->points[i / 2 % questions_.front()->points.size()]);
  }
  PlaceQuestion half = many;
  for (std::size_t i = 0; i < 64; ++i) half.points[i] = many.points[2 * i];
  half.points.resize(64);
  // The points come in pairs, so both halves, and their values, are equal.
  const auto close = [](const MatchSolution& a, const MatchSolution& b) {
    return (a.T_reference_query.position_m() - b.T_reference_query.position_m()).norm() < 1e-9 &&
           std::abs(a.fitness - b.fitness) < 1e-9;
  };
  const auto of_many = field_.answer(many);
  const auto of_half = field_.answer(half);
  EXPECT_TRUE(std::equal(of_many.begin(), of_many.end(), of_half.begin(), of_half.end(), close));
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
        changed([](auto& q) { q.points.resize(129); }), changed([](auto& q) { q.headings = 0; }),
        changed([](auto& q) { q.headings = 10; }), changed([](auto& q) { q.first_heading = 72; }),
        changed([](auto& q) { q.first_heading = 64; })}) {
    EXPECT_THROW(static_cast<void>(field_.answer(wrong)), std::invalid_argument);
  }
  EXPECT_TRUE(field_.questions({}).empty());
}

TEST_F(PlaceFieldTest, AWrongAnswerIsNamed) {
  const PlaceQuestion& question = *questions_[1];
  const std::vector<MatchSolution> right = field_.answer(question);
  ASSERT_GT(right.size(), 3U);
  EXPECT_EQ(field_.verify(question, right), "");
  const auto complaint = [&](auto change) {
    std::vector<MatchSolution> places = right;
    change(places);
    return field_.verify(question, places);
  };
  EXPECT_THAT(complaint([](auto& p) { p[0].fitness += 0.1; }),
              HasSubstr("the value of place 1 is"));
  EXPECT_THAT(complaint([](auto& p) { p[1].T_reference_query.x_m += 20.0; }),
              HasSubstr("place 2 is outside"));
  EXPECT_THAT(complaint([](auto& p) { p[1].T_reference_query.x_m = std::nan(""); }),
              HasSubstr("place 2 is outside"));
  EXPECT_THAT(complaint([](auto& p) { p[2].T_reference_query.theta_rad -= 2.0; }),
              HasSubstr("place 3 is outside"));
  EXPECT_THAT(complaint([](auto& p) { p[2].T_reference_query.theta_rad += 7.0; }),
              HasSubstr("place 3 is outside"));
  EXPECT_THAT(complaint([](auto& p) { p.resize(39, p.back()); }), HasSubstr("39 places"));
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
  EXPECT_EQ(result.solutions, field_.answer(*task.places));
  EXPECT_EQ(matcher.verify(task, result), "");
  MatchResult wrong = result;
  wrong.solutions.front().fitness += 0.1;
  EXPECT_NE(matcher.verify(task, wrong), "");
}

}  // namespace
}  // namespace topogeo::localization
