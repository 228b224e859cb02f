// The current search of the localizer, on the hub.
#pragma once

#include <optional>

#include "topogeo/msg/search.h"
#include "topogeo/service/service.hpp"

#include "server/channel_hub.hpp"

namespace topogeo::web {

class DriveView;

/// Lives in the loop of its service.
class SearchView {
 public:
  /// `drive` gives the poses of stops to which hypotheses are relative; it must outlive this
  /// object.
  SearchView(service::Service& service, ChannelHub& hub, const DriveView& drive);

 private:
  void show(const msg::Search& search);

  ChannelHub& hub_;
  const DriveView& drive_;
  std::optional<msg::Search> newest_;  // not yet shown
};

}  // namespace topogeo::web
