// Whether a map that was made of a log can be relied on.
#pragma once

#include "topogeo/storage/report.hpp"

#include "common/job.hpp"

namespace topogeo::cli {

/// Throws service::BadInputError, with the reason and what would help, if the map that was made of
/// the log is probably wrong (results::is_unreliable).
void check_reliable(const JobOptions& options, const storage::Report& report);

}  // namespace topogeo::cli
