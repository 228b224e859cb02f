#include "channels/search_view.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include "topogeo/service/conversions.hpp"

#include "channels/drive_view.hpp"
#include "channels/protocol_names.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

/// The stops of a search arrive with the trajectory, which is shown a little later.
constexpr std::chrono::milliseconds kSearchDelay{300};

template <class Sequence>
Json hypotheses_json(const Sequence& hypotheses, const geometry::Pose2& T_map_base) {
  Json out = Json::array();
  for (const msg::SearchHypothesis& hypothesis : hypotheses) {
    const geometry::Pose2 T_map_robot = T_map_base * service::from_msg(hypothesis.T_base_robot());
    out.push_back(Json::array({rounded(T_map_robot.x_m), rounded(T_map_robot.y_m),
                               rounded(T_map_robot.theta_rad), rounded(hypothesis.fitness())}));
  }
  return out;
}

Json match_json(const msg::SearchedMatch& match, const geometry::Pose2& T_map_base) {
  Json json;
  set_pose(json, T_map_base * service::from_msg(match.T_base_stop()));
  json["base_theta_rad"] = rounded(T_map_base.theta_rad);
  json["half_widths"] =
      Json::array({rounded(match.half_width_x_m()), rounded(match.half_width_y_m()),
                   rounded(match.half_width_rad())});
  json["covariance"] = Json::array();
  for (const double value : match.covariance()) json["covariance"].push_back(exact(value));
  json["done"] = match.done();
  if (match.done()) {
    json["accepted"] = match.accepted();
    json["reason"] = name_of(match.reason());
    json["fitness"] = rounded(match.fitness());
  }
  json["hypotheses"] = hypotheses_json(match.hypotheses(), T_map_base);
  return json;
}

}  // namespace

SearchView::SearchView(service::Service& service, ChannelHub& hub, const DriveView& drive)
    : hub_(hub), drive_(drive) {
  service.subscribe<msg::Search>([this](const msg::Search& search) { newest_ = search; },
                                 {.of_map = true});
  service.loop().add_timer(kSearchDelay, [this] {
    if (const auto search = std::exchange(newest_, std::nullopt)) show(*search);
  });
}

void SearchView::show(const msg::Search& search) {
  Json matches = Json::array();
  for (const msg::SearchedMatch& match : search.matches()) {
    const auto T_map_base = drive_.pose_of(service::from_msg(match.base()));
    if (T_map_base) matches.push_back(match_json(match, *T_map_base));
  }
  hub_.set(Channel::kSearch,
           text_of(Json{{"stamp_s", seconds(search.stamp_ns())},
                        {"tasks", search.tasks()},
                        {"running", search.running()},
                        {"whole_map", search.whole_map()},
                        {"matches", std::move(matches)},
                        {"hypotheses", hypotheses_json(search.hypotheses(), {})}}));
}

}  // namespace topogeo::web
