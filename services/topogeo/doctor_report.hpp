// What `topogeo doctor` has found, for people and for programs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "text_grid.hpp"

namespace topogeo::cli {

enum class Severity : std::uint8_t {
  kGood,
  kHint,    ///< works, but less well or not for long
  kProblem  ///< does not work, or loses data
};

/// One result of a check.
struct Finding {
  std::string check;  ///< short name of the check
  Severity severity = Severity::kGood;
  std::string what;
  std::string why;     ///< it matters; empty when all is well
  std::string remedy;  ///< what to do
};

/// A check of facts: what is wrong, nothing when all is well, and what is reported then.
template <class Facts>
struct Check {
  const char* name;
  std::vector<Finding> (*find)(const Facts& facts);
  std::string (*good)(const Facts& facts);
};

/// The findings of all checks in their order, one of Severity::kGood where a check has none.
template <class Facts>
std::vector<Finding> run_checks(std::span<const Check<Facts>> checks, const Facts& facts) {
  std::vector<Finding> all;
  for (const Check<Facts>& check : checks) {
    std::vector<Finding> found = check.find(facts);
    if (found.empty()) found.push_back({"", Severity::kGood, check.good(facts), "", ""});
    for (Finding& finding : found) {
      finding.check = check.name;
      all.push_back(std::move(finding));
    }
  }
  return all;
}

std::size_t count(std::span<const Finding> findings, Severity severity);

/// A line for each finding, why and what to do below those that are not good, then the sums. Lines
/// have at most `columns` bytes unless a command that they quote is longer.
std::string findings_text(std::span<const Finding> findings, std::size_t columns = kColumns);
/// {"problems": n, "hints": n, "findings": [{"check", "severity", "what", "why", "remedy"}]}
std::string findings_json(std::span<const Finding> findings);

}  // namespace topogeo::cli
