#include "drawing_options.hpp"

#include <exception>
#include <stdexcept>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/service_options.hpp"

namespace topogeo::map_store {

namespace {

geometry::Pose2 pose_of(const DrawingOptions& options) {
  if (!options.pose) return {};
  try {
    return pipeline::parse_pose(*options.pose);
  } catch (const std::invalid_argument& error) {
    throw service::UsageError(std::string("--drawing-pose: ") + error.what());
  }
}

}  // namespace

void add_drawing_options(command_line::Command& app, DrawingOptions& options) {
  app.add_option("--drawing", options.drawing,
                 "drawn floor: a world (.world.yaml) or a grid (.yaml with its .pgm)")
      ->type_name("FILE");
  app.add_option("--zones", options.zones,
                 "zones and places of the drawing (YAML), in its own frame")
      ->type_name("FILE");
  app.add_option("--drawing-pose", options.pose,
                 "pose of the drawing's origin in the map; default: 0,0,0")
      ->type_name("X,Y,DEG");
  app.add_option("--places", options.places, "places and zones (YAML) in the map frame")
      ->type_name("FILE");
}

storage::MapDrawing read_drawing(const DrawingOptions& options, double resolution_m) {
  if (!options.drawing && (options.zones || options.pose)) {
    throw service::UsageError("--zones and --drawing-pose need --drawing (see --help)");
  }
  const geometry::Pose2 T_map_drawing = pose_of(options);
  try {
    storage::MapDrawing drawing;
    if (options.drawing) {
      drawing =
          pipeline::read_drawing(*options.drawing, options.zones, resolution_m, T_map_drawing);
    }
    if (options.places) {
      pipeline::lay_over(drawing, pipeline::read_zones_and_places(*options.places));
    }
    return drawing;
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

}  // namespace topogeo::map_store
