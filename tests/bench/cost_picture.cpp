#include "cost_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include <cairo.h>

namespace topogeo::bench {
namespace {

constexpr int kWidth_px = 1200;
constexpr int kHeight_px = 600;
constexpr double kLeft_px = 80.0;
constexpr double kRight_px = 1170.0;
constexpr double kTop_px = 50.0;
constexpr double kBottom_px = 540.0;
constexpr double kLeast_ms = 0.1;

struct Axes {
  double longest_m;
  double most_ms;  // a power of ten

  [[nodiscard]] double x_px(double path_m) const {
    return kLeft_px + (kRight_px - kLeft_px) * path_m / longest_m;
  }
  [[nodiscard]] double y_px(double ms) const {
    const double share =
        std::log10(std::max(ms, kLeast_ms) / kLeast_ms) / std::log10(most_ms / kLeast_ms);
    return kBottom_px - (kBottom_px - kTop_px) * share;
  }
};

void write(cairo_t* cairo, double x_px, double y_px, const std::string& text) {
  cairo_move_to(cairo, x_px, y_px);
  cairo_show_text(cairo, text.c_str());
}

void draw_axes(cairo_t* cairo, const Axes& axes, const std::string& title) {
  cairo_set_font_size(cairo, 16.0);
  cairo_set_source_rgb(cairo, 0.0, 0.0, 0.0);
  write(cairo, kLeft_px, 30.0, title);
  cairo_set_font_size(cairo, 13.0);
  write(cairo, kRight_px - 80.0, kBottom_px + 45.0, "way driven, m");
  write(cairo, 8.0, kTop_px - 10.0, "CPU, ms");
  cairo_set_line_width(cairo, 0.5);
  std::array<char, 32> text{};
  for (double ms = kLeast_ms; ms <= axes.most_ms * 1.001; ms *= 10.0) {
    cairo_set_source_rgb(cairo, 0.8, 0.8, 0.8);
    cairo_move_to(cairo, kLeft_px, axes.y_px(ms));
    cairo_line_to(cairo, kRight_px, axes.y_px(ms));
    cairo_stroke(cairo);
    cairo_set_source_rgb(cairo, 0.0, 0.0, 0.0);
    std::snprintf(text.data(), text.size(), "%g", ms);
    write(cairo, 30.0, axes.y_px(ms) + 5.0, text.data());
  }
  const double step_m = axes.longest_m > 1000.0 ? 200.0 : (axes.longest_m > 200.0 ? 50.0 : 10.0);
  for (int i = 0; i * step_m <= axes.longest_m; ++i) {
    std::snprintf(text.data(), text.size(), "%g", i * step_m);
    write(cairo, axes.x_px(i * step_m) - 10.0, kBottom_px + 20.0, text.data());
  }
}

// The quantile over each window of steps, as a line.
void draw_quantile(cairo_t* cairo, const Axes& axes, const std::vector<StepCost>& steps,
                   double quantile) {
  constexpr std::size_t kWindow = 100;
  cairo_new_path(cairo);  // text leaves its end behind as the current point
  for (std::size_t from = 0; from < steps.size(); from += kWindow) {
    const std::size_t to = std::min(from + kWindow, steps.size());
    std::vector<double> costs_ms;
    for (std::size_t i = from; i < to; ++i) costs_ms.push_back(steps[i].cpu_ms);
    std::sort(costs_ms.begin(), costs_ms.end());
    const auto index =
        static_cast<std::size_t>(quantile * static_cast<double>(costs_ms.size() - 1));
    cairo_line_to(cairo, axes.x_px(0.5 * (steps[from].path_m + steps[to - 1].path_m)),
                  axes.y_px(costs_ms[index]));
  }
  cairo_stroke(cairo);
}

}  // namespace

void draw_costs(const std::string& file, const std::string& title,
                const std::vector<StepCost>& steps) {
  if (steps.empty()) throw std::invalid_argument("steps: expected one or more, got none");
  Axes axes{std::max(steps.back().path_m, 1.0), 10.0};
  for (const StepCost& step : steps) {
    while (step.cpu_ms > axes.most_ms) axes.most_ms *= 10.0;
  }
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, kWidth_px, kHeight_px), cairo_surface_destroy);
  const std::unique_ptr<cairo_t, decltype(&cairo_destroy)> cairo(cairo_create(surface.get()),
                                                                 cairo_destroy);
  cairo_set_source_rgb(cairo.get(), 1.0, 1.0, 1.0);
  cairo_paint(cairo.get());
  draw_axes(cairo.get(), axes, title);
  cairo_set_source_rgb(cairo.get(), 0.6, 0.6, 0.65);
  for (const StepCost& step : steps) {
    cairo_rectangle(cairo.get(), axes.x_px(step.path_m) - 1.0, axes.y_px(step.cpu_ms) - 1.0, 2.0,
                    2.0);
  }
  cairo_fill(cairo.get());
  cairo_set_line_width(cairo.get(), 2.0);
  cairo_set_source_rgb(cairo.get(), 0.1, 0.3, 0.8);
  draw_quantile(cairo.get(), axes, steps, 0.5);
  write(cairo.get(), kLeft_px + 10.0, kTop_px + 10.0, "median of 100 steps");
  cairo_set_source_rgb(cairo.get(), 0.85, 0.2, 0.1);
  draw_quantile(cairo.get(), axes, steps, 0.95);
  write(cairo.get(), kLeft_px + 10.0, kTop_px + 28.0, "95th percentile");
  const cairo_status_t status = cairo_surface_write_to_png(surface.get(), file.c_str());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(file + ": cannot write: " + cairo_status_to_string(status));
  }
}

}  // namespace topogeo::bench
