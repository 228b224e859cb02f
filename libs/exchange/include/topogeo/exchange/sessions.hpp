// The sessions of a map, and the map without some of them: a merge that was wrong is undone, a
// drive that is no longer wanted goes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/global_map_config.hpp"

namespace topogeo::exchange {

struct SessionSummary {
  std::uint64_t session = 0;  ///< 0: files of before do not say
  std::size_t stops = 0;
  std::uint32_t first_stop = 0;  ///< local map id
  std::int64_t first_stamp_ns = 0;
  std::int64_t last_stamp_ns = 0;
};

/// In the order in which they came.
std::vector<SessionSummary> sessions_of(const storage::MapDocument& document);

/// "00c0ffee00c0ffee", and back; nothing for any other text.
std::string session_text(std::uint64_t session);
std::optional<std::uint64_t> session_of_text(std::string_view text);

/// The map without the stops of a session: numbered anew, without what was measured to or from
/// those stops. Where the map keeps its measurements the other poses are optimised anew, so that
/// nothing of the session stays in them; the first stop stays where it is. Nodes and branches are
/// made anew. Throws std::invalid_argument when no stop is of the session or all are.
storage::MapDocument without_session(const storage::MapDocument& document, std::uint64_t session,
                                     const topomap::GlobalMapConfig& config);

}  // namespace topogeo::exchange
