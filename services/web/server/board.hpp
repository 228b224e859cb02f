// The former header of channel_hub.hpp, for files that still include it.
#pragma once

#include "server/channel_hub.hpp"
