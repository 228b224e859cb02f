// The merges proposed by a localizer of several robots, as `topogeo store merges` shows them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "topogeo/session/merge_proposals.hpp"

namespace topogeo::cli {

class MergeTable {
 public:
  using Proposal = localization::MergeProposal;

  /// A later proposal of the same number replaces it.
  void put(const Proposal& proposal) { proposals_[proposal.number] = proposal; }
  /// The number in the localizer's status: proposals for a late reader take a while.
  void expect(double count) { expected_ = count; }

  [[nodiscard]] bool has_localizer() const { return expected_.has_value(); }
  /// The localizer has published the number of proposals, and all have arrived.
  [[nodiscard]] bool is_complete() const {
    return expected_ && static_cast<double>(proposals_.size()) >= *expected_;
  }
  /// "1 of 3 proposals".
  [[nodiscard]] std::string progress() const;

  /// For people: three lines for each proposal, in the order of their numbers.
  [[nodiscard]] std::string text() const;
  /// For programs: an array of objects with the fields of localization::MergeProposal.
  [[nodiscard]] std::string json() const;

 private:
  std::map<std::uint32_t, Proposal> proposals_;
  std::optional<double> expected_;
};

}  // namespace topogeo::cli
