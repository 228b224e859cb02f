#include "topogeo/recording/ros_definitions.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace topogeo::recording {
namespace {

constexpr std::array kDefinitions = {
    RosDefinition{"builtin_interfaces/msg/Time", "int32 sec\nuint32 nanosec\n", "", ""},
    RosDefinition{"builtin_interfaces/msg/Duration", "int32 sec\nuint32 nanosec\n", "", ""},
    RosDefinition{"std_msgs/msg/Header", "builtin_interfaces/Time stamp\nstring frame_id\n", "",
                  ""},
    RosDefinition{"std_msgs/msg/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n", "", ""},
    RosDefinition{"geometry_msgs/msg/Point", "float64 x\nfloat64 y\nfloat64 z\n", "", ""},
    RosDefinition{"geometry_msgs/msg/Vector3", "float64 x\nfloat64 y\nfloat64 z\n", "", ""},
    RosDefinition{"geometry_msgs/msg/Quaternion",
                  "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n", "", ""},
    RosDefinition{"geometry_msgs/msg/Pose", "Point position\nQuaternion orientation\n", "", ""},
    RosDefinition{"geometry_msgs/msg/PoseStamped", "std_msgs/Header header\nPose pose\n", "", ""},
    RosDefinition{"geometry_msgs/msg/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n", "",
                  ""},
    RosDefinition{"geometry_msgs/msg/PoseWithCovarianceStamped",
                  "std_msgs/Header header\nPoseWithCovariance pose\n", "",
                  "26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"},
    RosDefinition{"geometry_msgs/msg/Transform", "Vector3 translation\nQuaternion rotation\n", "",
                  ""},
    RosDefinition{"geometry_msgs/msg/TransformStamped",
                  "std_msgs/Header header\nstring child_frame_id\nTransform transform\n", "", ""},
    RosDefinition{"geometry_msgs/msg/Twist", "Vector3 linear\nVector3 angular\n", "", ""},
    RosDefinition{"geometry_msgs/msg/TwistWithCovariance", "Twist twist\nfloat64[36] covariance\n",
                  "", ""},
    RosDefinition{"sensor_msgs/msg/LaserScan",
                  "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\n"
                  "float32 angle_increment\nfloat32 time_increment\nfloat32 scan_time\n"
                  "float32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities\n",
                  "90c7ef2dc6895d81024acba2ac42f369",
                  "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
    RosDefinition{"sensor_msgs/msg/CompressedImage",
                  "std_msgs/Header header\nstring format\nuint8[] data\n", "", ""},
    RosDefinition{"nav_msgs/msg/Odometry",
                  "std_msgs/Header header\nstring child_frame_id\n"
                  "geometry_msgs/PoseWithCovariance pose\n"
                  "geometry_msgs/TwistWithCovariance twist\n",
                  "cd5e73d190d741a2f92e81eda573aca7",
                  "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
    RosDefinition{"nav_msgs/msg/MapMetaData",
                  "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\n"
                  "uint32 height\ngeometry_msgs/Pose origin\n",
                  "", ""},
    RosDefinition{"nav_msgs/msg/OccupancyGrid",
                  "std_msgs/Header header\nMapMetaData info\nint8[] data\n", "",
                  "8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
    RosDefinition{"tf2_msgs/msg/TFMessage", "geometry_msgs/TransformStamped[] transforms\n",
                  "94810edda583a504dfda3829e70d7eec",
                  "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
    RosDefinition{"visualization_msgs/msg/UVCoordinate", "float32 u\nfloat32 v\n", "", ""},
    RosDefinition{"visualization_msgs/msg/MeshFile", "string filename\nuint8[] data\n", "", ""},
    RosDefinition{"visualization_msgs/msg/Marker",
                  "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n"
                  "geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n"
                  "builtin_interfaces/Duration lifetime\nbool frame_locked\n"
                  "geometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\n"
                  "string texture_resource\nsensor_msgs/CompressedImage texture\n"
                  "UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\n"
                  "MeshFile mesh_file\nbool mesh_use_embedded_materials\n",
                  "", ""},
    RosDefinition{"visualization_msgs/msg/MarkerArray", "Marker[] markers\n", "",
                  "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"},
};

const RosDefinition& known(std::string_view type) {
  const RosDefinition* definition = find_definition(type);
  if (definition == nullptr) {
    throw std::invalid_argument("expected a known message type, got " + std::string(type));
  }
  return *definition;
}

std::string_view package_of(std::string_view type) {
  return type.substr(0, type.find('/'));
}

/// The type of a field's first word, such as "Pose[36]" or "std_msgs/Header"; null for numbers and
/// texts.
const RosDefinition* type_of_field(std::string_view word, std::string_view package) {
  word = word.substr(0, word.find('['));
  const std::size_t slash = word.find('/');
  const std::string_view owner = slash == std::string_view::npos ? package : word.substr(0, slash);
  const std::string_view name = slash == std::string_view::npos ? word : word.substr(slash + 1);
  return find_definition(std::string(owner) + "/msg/" + std::string(name));
}

template <typename Use>
void for_each_line(std::string_view text, Use use) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    use(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
}

/// The types that a type consists of, itself first, each once, in the order of occurrence.
std::vector<const RosDefinition*> with_parts(std::string_view type) {
  std::vector<const RosDefinition*> all = {&known(type)};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const RosDefinition& owner = *all[i];
    for_each_line(owner.fields, [&](std::string_view line) {
      const RosDefinition* part =
          type_of_field(line.substr(0, line.find(' ')), package_of(owner.type));
      if (part != nullptr && std::ranges::find(all, part) == all.end()) all.push_back(part);
    });
  }
  return all;
}

/// Fields in the form of ROS 1: times are built in, headers are numbered, a pose's quaternion has
/// no defaults.
std::string ros1_fields(const RosDefinition& definition) {
  std::string text;
  if (definition.type == "std_msgs/msg/Header") text += "uint32 seq\n";
  for_each_line(definition.fields, [&](std::string_view line) {
    std::string_view word = line.substr(0, line.find(' '));
    std::string_view rest = line.substr(word.size() + 1);
    rest = rest.substr(0, rest.find(' '));
    if (word == "builtin_interfaces/Time") word = "time";
    if (word == "std_msgs/Header") word = "Header";
    text += std::string(word) + " " + std::string(rest) + "\n";
  });
  return text;
}

constexpr std::size_t kRule = 80;

}  // namespace

const RosDefinition* find_definition(std::string_view type) {
  const auto* const found = std::ranges::find(kDefinitions, type, &RosDefinition::type);
  return found == kDefinitions.end() ? nullptr : found;
}

std::string ros1_type_name(std::string_view type) {
  const std::size_t middle = type.find("/msg/");
  if (middle == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, middle)) + "/" + std::string(type.substr(middle + 5));
}

std::string ros2_definition_text(std::string_view type) {
  std::string text;
  for (const RosDefinition* part : with_parts(type)) {
    if (part->type != type) {
      text += std::string(kRule, '=') + "\nMSG: " + ros1_type_name(part->type) + "\n";
    }
    text += part->fields;
  }
  return text;
}

std::string ros1_definition_text(std::string_view type) {
  std::string text;
  for (const RosDefinition* part : with_parts(type)) {
    if (part->type == "builtin_interfaces/msg/Time") continue;
    if (part->type != type) {
      text += "\n" + std::string(kRule, '=') + "\nMSG: " + ros1_type_name(part->type) + "\n";
    }
    text += ros1_fields(*part);
  }
  return text;
}

}  // namespace topogeo::recording
