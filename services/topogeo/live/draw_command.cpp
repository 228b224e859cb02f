// topogeo draw: shows or replaces the drawing on the live map.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/drawing.h"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/service/drawing_conversions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/patience.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "common/service_request.hpp"

namespace topogeo::cli {
namespace {

struct DrawOptions {
  std::optional<std::filesystem::path> file;
  std::optional<std::uint64_t> version;
  DomainView view;
  std::string robot_id = "robot";
  double wait_s = 5.0;
};

constexpr const char* kMapStore = "map store";

msg::DrawingState live_drawing(const DrawOptions& options) {
  const messaging::Participant participant =
      join_for(options.view, "topogeo/draw", options.robot_id);
  messaging::Reader<msg::DrawingState> reader(participant);
  support::Patience patience(options.wait_s, support::monotonic_s());
  std::optional<msg::DrawingState> newest;
  while (!newest && !patience.is_over(support::monotonic_s())) {
    if (!reader.wait_for_data(std::chrono::milliseconds(100))) continue;
    reader.take([&](const msg::DrawingState& state, const messaging::SampleInfo& info) {
      if (info.valid && state.robot_id() == options.robot_id.c_str()) newest = state;
    });
  }
  if (newest) return *newest;
  throw std::runtime_error(nothing_alive(options.view, kMapStore) + patience.reason());
}

int show(const DrawOptions& options) {
  const msg::DrawingState state = live_drawing(options);
  storage::MapDrawing drawing = service::from_msg(state.content());
  std::cout << fmt::format("# version {}{}{}\n", state.version(),
                           state.has_grid() ? ", over a drawn grid" : "",
                           state.is_stored() ? "" : ", not stored: the map is read-only")
            << planning::zone_drawing_text(
                   {std::move(drawing.zones), std::move(drawing.places), std::move(drawing.lines)});
  return service::kOk;
}

storage::MapDrawing drawing_of(const std::filesystem::path& file) {
  try {
    storage::MapDrawing drawing = pipeline::read_zones_and_places(file);
    service::check_drawing(drawing);
    service::check_rules(drawing);
    return drawing;
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

int replace(const DrawOptions& options) {
  msg::DrawingOrder order;
  order.content(service::to_msg(drawing_of(*options.file)));
  order.version(options.version ? *options.version : live_drawing(options).version());
  messaging::set_header(order, options.robot_id, support::wall_clock_ns(), 0);
  const auto answer = ask<msg::DrawingAnswer>(
      {options.view, options.robot_id, options.wait_s, kMapStore}, std::move(order));
  const bool done = answer.result() == msg::kDrawingDone;
  if (done) std::cout << "version " << answer.version() << '\n';
  if (!answer.message().to_string().empty()) {
    std::cerr << "topogeo: " << answer.message().c_str() << '\n';
  }
  return done ? service::kOk : service::kFailure;
}

}  // namespace

void add_draw_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("draw", "Show the drawing of the live map, or replace it by a file");
  auto options = std::make_shared<DrawOptions>();
  command
      ->add_option("file", options->file,
                   "zones, places, walls, openings and doors (YAML): the whole drawing from now on")
      ->type_name("FILE");
  command
      ->add_option("--if-version", options->version,
                   "refuse the file unless this is still the version of the drawing")
      ->needs(command->get_option("file"));
  add_robot_option(*command, options->robot_id, "robot of the live map");
  add_domain_options(*command, options->view);
  command->add_option("--wait-seconds", options->wait_s, "how long to wait for the map store")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
  command->callback(
      [options, &exit_code] { exit_code = options->file ? replace(*options) : show(*options); });
}

}  // namespace topogeo::cli
