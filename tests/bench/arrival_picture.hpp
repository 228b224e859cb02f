// A picture of one simulated drive to a goal, and its numbers as a table.
#pragma once

#include <filesystem>
#include <string>

#include "arrival_run.hpp"

namespace topogeo::bench {

/// PNG in the map frame: the grid of the map (occupied dark, unknown grey), the world's surfaces in
/// black, the obstacle in orange, routes in blue, the true path in red, the estimated one in green.
/// Throws std::runtime_error naming the file.
void write_arrival_picture(const std::filesystem::path& file, const MappedFloor& floor,
                           const ArrivalTask& task, const ArrivalRecord& record,
                           const std::string& title);

/// CSV, a line for each point of the trace. Throws std::runtime_error naming the file.
void write_trace(const std::filesystem::path& file, const MappedFloor& floor,
                 const ArrivalRecord& record);

}  // namespace topogeo::bench
