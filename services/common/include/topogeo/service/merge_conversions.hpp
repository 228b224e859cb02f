// Proposals to merge the maps of two robots, between messages and localization.
#pragma once

#include <cstdint>
#include <string_view>

#include "topogeo/msg/merge.h"
#include "topogeo/session/merge_proposals.hpp"

namespace topogeo::service {

/// `robot_id`: robot whose map it is.
msg::MergeProposal to_msg(const localization::MergeProposal& proposal, std::string_view robot_id,
                          std::int64_t stamp_ns, std::uint64_t sequence_number);
/// Throws std::invalid_argument naming the field and the expected value. The match comes back with
/// its two stops only.
localization::MergeProposal from_msg(const msg::MergeProposal& message);

}  // namespace topogeo::service
