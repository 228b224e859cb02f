// Options of a localizer as a client of the search pool.
#pragma once

#include "topogeo/service/service.hpp"

#include "remote_pool.hpp"

namespace topogeo::localizer {

RemotePoolOptions pool_options(const service::Service& service);

}  // namespace topogeo::localizer
