// Local maps of many scans of a log as thumbnails on one page.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "topogeo/render/map_picture.hpp"
#include "topogeo/render/picture_format.hpp"
#include "topogeo/render/scan_view.hpp"

namespace topogeo::render {

constexpr std::size_t kMostThumbnails = 600;  ///< a PNG cannot be higher than 32,767 pixels

/// The bytes of the file, `max_width_px` wide, with the `views` row by row. The same views give the
/// same SVG bytes. Throws std::invalid_argument for a width out of range, no view or more than
/// kMostThumbnails.
std::string contact_sheet(const std::vector<ScanView>& views, const std::string& title,
                          PictureFormat format, const PictureOptions& options = {});

}  // namespace topogeo::render
