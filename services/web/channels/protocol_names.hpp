// The words of the protocol for the enumerations of messages.
#pragma once

#include <string>
#include <string_view>

#include "topogeo/msg/merge.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/trajectory.h"

namespace topogeo::web {

std::string_view name_of(msg::LocalizationState state);
std::string_view name_of(msg::NavigatorState state);
std::string_view name_of(msg::HaltReason reason);
std::string_view name_of(msg::BaseState state);
std::string_view name_of(msg::LaserState state);
std::string_view name_of(msg::NodeKind kind);
std::string_view name_of(msg::LoopOutcome outcome);
std::string_view name_of(msg::ProposalSource source);
std::string_view name_of(msg::MatchReason reason);
std::string_view name_of(msg::ServiceState state);
std::string_view name_of(msg::MergeState state);

/// Explains a state of the localizer in a sentence.
std::string reason_of(msg::LocalizationState state);

}  // namespace topogeo::web
