// How a localizer takes part in the search pool.
#pragma once

#include "topogeo/service/service.hpp"

#include "remote_pool.hpp"

namespace topogeo::localizer {

RemotePoolOptions pool_options(const service::Service& service);

}  // namespace topogeo::localizer
