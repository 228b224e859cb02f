// A pool that solves a task once, however many cases of a test program request it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "topogeo/matching/matcher.hpp"

namespace topogeo::localization::test {

/// All fields of a task that determine its answer.
class TaskKey {
 public:
  explicit TaskKey(const MatchTask& task) {
    add(task.seed);
    for (const geometry::Pose2& pose : task.initial_individuals) add_pose(pose);
    if (task.places) {
      add_question(*task.places);
    } else {
      add_match(task);
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  template <class Value>
  void add(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    const auto* bytes = reinterpret_cast<const char*>(&value);
    text_.append(bytes, sizeof(Value));
  }
  void add_pose(const geometry::Pose2& pose) {
    add(pose.x_m);
    add(pose.y_m);
    add(pose.theta_rad);
  }
  void add_question(const PlaceQuestion& question) {
    add(question.field_hash);
    add(question.first_heading);
    add(question.headings);
    for (const topomap::ScanPoint& point : question.points) {
      add(point.x_m);
      add(point.y_m);
    }
  }
  void add_match(const MatchTask& task) {
    // No padding between the members, which could have any value.
    static_assert(sizeof(GeneticParameters) == 4 * sizeof(std::uint32_t) + 6 * sizeof(double));
    static_assert(sizeof(GateConfig) == 6 * sizeof(double));
    add(task.reference_hash);
    add(task.query_hash);
    add_pose(task.T_reference_query);
    for (int i = 0; i < 9; ++i) add(task.covariance(i));
    for (int i = 0; i < 3; ++i) add(task.half_width(i));
    add(task.genetic);
    add(task.fitness_form);
    add(task.evidence);
    add(task.solutions_wanted);
    add(task.gate);
  }

  std::string text_;
};

/// Solves only tasks that no pool of this class has solved: an answer depends on its task alone
/// (match.hpp), which cases with an InProcessPool check.
class RememberingPool : public MatchPool {
 public:
  void add_map(std::shared_ptr<const topomap::LocalMap> map) override {
    pool_.add_map(std::move(map));
  }
  void add_field(std::shared_ptr<const PlaceField> field) override {
    pool_.add_field(std::move(field));
  }
  std::vector<MatchResult> match(std::span<const MatchTask> tasks) override {
    std::vector<MatchResult> results;
    for (const MatchTask& task : tasks) {
      const auto [known, is_new] = solved().try_emplace(TaskKey(task).text());
      if (is_new) known->second = pool_.match({&task, 1}).front();
      results.push_back(known->second);
      results.back().task_id = task.task_id;
    }
    return results;
  }

 private:
  static std::unordered_map<std::string, MatchResult>& solved() {
    static std::unordered_map<std::string, MatchResult> results;
    return results;
  }

  InProcessPool pool_;
};

}  // namespace topogeo::localization::test
