// The findings of `topogeo doctor`, for people and for programs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/text_grid.hpp"

namespace topogeo::cli {

enum class Severity : std::uint8_t {
  kGood,
  kHint,    ///< the system works, but less well or not for long
  kProblem  ///< does not work, or loses data
};

/// One result of a check.
struct Finding {
  std::string check;  ///< short name of the check
  Severity severity = Severity::kGood;
  std::string what;
  std::string why;     ///< consequence of the finding; empty when all is well
  std::string remedy;  ///< what to do
};

/// A check of facts: its findings, none when all is well, and the text for that case.
template <class Facts>
struct Check {
  const char* name;
  std::vector<Finding> (*find)(const Facts& facts);
  std::string (*good)(const Facts& facts);
};

/// The findings of all checks in order, with one of Severity::kGood for a check without findings.
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

/// One line per finding, with reason and remedy below the bad ones, then the totals. Lines have at
/// most `columns` bytes unless they quote a longer command.
std::string findings_text(std::span<const Finding> findings, std::size_t columns = kColumns);
/// {"problems": n, "hints": n, "findings": [{"check", "severity", "what", "why", "remedy"}]}
std::string findings_json(std::span<const Finding> findings);

}  // namespace topogeo::cli
