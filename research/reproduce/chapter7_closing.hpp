// Parts that the figures of the backward correction share.
#pragma once

#include <string>

#include "reproduce/experiment.hpp"
#include "reproduce/shared_runs.hpp"

namespace topogeo::reproduce {

/// The drive along the corridor and back.
inline constexpr const char* kTurn = "turn";

/// The first backward correction. Throws std::runtime_error if no cycle was closed.
const Correction::Backward& first_closing(const Correction& correction);

/// Whether there is a backward correction to show; the row states it.
bool closes(Report& report, const Correction& correction);

/// The walls of the drive's corridor.
render::FigurePanel corridor_panel(const Drive& drive, const std::string& title);

}  // namespace topogeo::reproduce
