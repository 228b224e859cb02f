// Lists the sessions of a map and removes them: undoes a wrong merge or drops an unwanted drive.
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
  std::uint64_t session = 0;  ///< 0: unknown, in older files
  std::size_t stops = 0;
  std::uint32_t first_stop = 0;  ///< local map id
  std::int64_t first_stamp_ns = 0;
  std::int64_t last_stamp_ns = 0;
};

/// The sessions in their order in the map.
std::vector<SessionSummary> sessions_of(const storage::MapDocument& document);

/// "00c0ffee00c0ffee", and the reverse; nothing for any other text.
std::string session_text(std::uint64_t session);
std::optional<std::uint64_t> session_of_text(std::string_view text);

/// The map without the stops of a session, renumbered, and without the measurements to or from
/// those stops. If the map keeps its measurements, the other poses are optimised anew, so that
/// nothing of the session remains in them; the first stop keeps its pose. Nodes and branches are
/// made anew. Throws std::invalid_argument if no stop is of the session, or if all are.
storage::MapDocument without_session(const storage::MapDocument& document, std::uint64_t session,
                                     const topomap::GlobalMapConfig& config);

}  // namespace topogeo::exchange
