// The lines above the picture of one scan.
#pragma once

#include <string>

#include "topogeo/render/scan_view.hpp"

namespace topogeo::render {

/// Log, number and stamp of the scan, and whether its diagram is virtual.
std::string scan_title(const ScanView& view, const std::string& log_name);

/// Numbers of beams, groups, nodes of each kind and branches, and the limits used.
std::string scan_counts(const ScanView& view);

}  // namespace topogeo::render
