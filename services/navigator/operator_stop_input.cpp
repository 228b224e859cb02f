#include "operator_stop_input.hpp"

#include <utility>

#include "topogeo/service/base_confirmation.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::navigator {

OperatorStopInput::OperatorStopInput(service::Service& service, const std::filesystem::path& memory,
                                     navigation::Navigator& navigator,
                                     std::function<void()> on_change)
    : stop_(memory), navigator_(navigator), on_change_(std::move(on_change)) {
  if (stop_.holds()) spdlog::warn("an operator's stop of before this start holds");
  apply();
  service.subscribe<msg::BaseCommand>(
      [this](const msg::BaseCommand& command, const messaging::SampleInfo& info) {
        take(command, info.writer);
      });
}

void OperatorStopInput::take(const msg::BaseStatus& status) {
  if (!stop_.holds() || !service::holds(status)) return;
  stop_.hand_over();
  change();
}

void OperatorStopInput::take(const msg::BaseCommand& command, const messaging::Handle& writer) {
  if (!stop_.take(command, writer)) return;
  spdlog::warn("{} by {}", stop_.holds() ? "stopped" : "released", command.client_id().c_str());
  change();
}

void OperatorStopInput::change() {
  apply();
  on_change_();
}

}  // namespace topogeo::navigator
