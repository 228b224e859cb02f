// The results of all experiments as a page for people and as JSON for programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reproduce/experiment.hpp"

namespace topogeo::reproduce {

struct Outcome {
  const Experiment* experiment = nullptr;
  Means means{};
  std::vector<Value> values;
  std::vector<Table> tables;
  std::vector<std::string> notes;
  std::vector<ReportPicture> pictures;
  double wall_s = 0.0;
  std::string failure{};  ///< text of the exception; empty: none

  /// Verdict of the values; kDiffers after a failure.
  [[nodiscard]] Verdict verdict() const;
  /// "equal", "better" or "differs because ...", computed from the values.
  [[nodiscard]] std::string verdict_text() const;
};

/// The bytes of index.html; picture paths are relative to it.
std::string index_page(const std::vector<Outcome>& outcomes);
/// The bytes of index.json.
std::string index_json(const std::vector<Outcome>& outcomes);

/// Runs an experiment; its pictures go to `folder`, which exists. A failure becomes an outcome.
Outcome run_experiment(const Experiment& experiment, const std::filesystem::path& folder,
                       SharedRuns& runs);

}  // namespace topogeo::reproduce
