// Messages to many readers that filter.
#pragma once

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets what filter_info.cpp puts right linked in.
void keep_filter_info_out();

}  // namespace topogeo::messaging
