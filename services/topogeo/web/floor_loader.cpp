#include "web/floor_loader.hpp"

#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/drawn_world.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/drawing_conversions.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

#include "run/run_log.hpp"

namespace topogeo::cli {
namespace {

/// The zones file of a drawn floor: the drawing without its walls, which become the grid.
std::string zones_text(storage::MapDrawing drawing) {
  service::drop_grid_lines(drawing);
  service::check_rules(drawing);
  return planning::zone_drawing_text(
      {std::move(drawing.zones), std::move(drawing.places), std::move(drawing.lines)});
}

}  // namespace

RunOptions with_floor(RunOptions options, const msg::FloorOrder& order, const std::string& name) {
  const geometry::Pose2 T_floor_start = service::from_msg(order.T_floor_start());
  const storage::MapDrawing drawing = service::from_msg(order.content());
  const std::string world =
      pipeline::drawn_world_text(order.name().to_string(), drawing, T_floor_start);
  SimulatorOptions& simulation = options.simulation.value();
  simulation.world = options.job.out / (name + ".world.yaml");
  support::write_file_atomically(simulation.world, world);
  try {
    check_world(simulation);
  } catch (const std::exception& error) {
    throw std::invalid_argument(error.what());
  }
  DrawnFloor floor;
  floor.world = simulation.world;
  floor.zones = options.job.out / (name + ".zones.yaml");
  support::write_file_atomically(floor.zones, zones_text(drawing));
  const geometry::Pose2 T_start_floor = geometry::inverse(T_floor_start);
  floor.pose = fmt::format("{},{},{}", T_start_floor.x_m, T_start_floor.y_m,
                           T_start_floor.theta_rad * 180.0 / std::numbers::pi);
  options.floor = std::move(floor);
  // The map is new, so nothing of the previous map applies.
  options.job.map.reset();
  options.job.continued.reset();
  options.job.initial_pose.reset();
  return options;
}

FloorLoader::FloorLoader(const messaging::Participant& participant, messaging::EventLoop& loop,
                         RunOptions options, Load load)
    : loop_(loop),
      options_(std::move(options)),
      load_(std::move(load)),
      orders_(participant),
      answers_(participant) {
  loop.add<msg::FloorOrder>(orders_, [this](const msg::FloorOrder& order,
                                            const messaging::SampleInfo&) { on_order(order); });
  loop.add(answers_);
}

void FloorLoader::on_order(const msg::FloorOrder& order) {
  if (order.robot_id() != options_.job.robot_id.c_str()) return;
  if (answers_sent_ > 0 && last_.request_id() == order.request_id() &&
      last_.client_id() == order.client_id()) {
    static_cast<void>(answers_.write(last_));
    return;
  }
  try {
    RunOptions next = with_floor(options_, order, "floor-" + std::to_string(floors_ + 1));
    ++floors_;
    answer(order, msg::kDrawingDone, "the robot is put into the floor, a new map begins");
    load_(next);
    options_ = std::move(next);
  } catch (const std::invalid_argument& error) {
    answer(order, msg::kDrawingInvalid, error.what());
  } catch (const std::exception& error) {
    answer(order, msg::kDrawingNotDone, error.what());
  }
}

void FloorLoader::answer(const msg::FloorOrder& order, msg::DrawingResult result,
                         const std::string& message) {
  messaging::set_header(last_, options_.job.robot_id, support::wall_clock_ns(), answers_sent_++);
  last_.request_id(order.request_id());
  last_.client_id(order.client_id());
  last_.result(result);
  messaging::set_text_cut(last_.message(), message);
  static_cast<void>(answers_.write(last_));
}

}  // namespace topogeo::cli
