// What the localizer searches at the moment, on the board.
#pragma once

#include <optional>

#include "topogeo/msg/search.h"
#include "topogeo/service/service.hpp"

#include "server/board.hpp"

namespace topogeo::web {

class DriveView;

/// Lives in the loop of its service.
class SearchView {
 public:
  /// `drive` has the places of the stops that hypotheses are relative to, and outlives it.
  SearchView(service::Service& service, Board& board, const DriveView& drive);

 private:
  void show(const msg::Search& search);

  Board& board_;
  const DriveView& drive_;
  std::optional<msg::Search> newest_;  // not shown yet
};

}  // namespace topogeo::web
