#include "topogeo/matching/refinement.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "topogeo/geometry/portable_math.hpp"

#include "least_squares_steps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

// Fixed: matches depend on them, tasks do not carry them, and workers must give the answers of the
// localizer (matcher_fingerprint.hpp). They suit lasers with centimetres of noise.
constexpr std::size_t kFewestPoints = 12;  // fewer do not determine three unknowns
constexpr ShrinkingGate kGate{0.50, 0.20, 0.06};
constexpr double kCauchy_m = 0.05;  // error of a reading: one twice as large weighs a fifth
// Deviation of one residual. Larger than the laser's noise, because the residuals of neighbouring
// beams are not independent.
constexpr double kResidualSigma_m = 0.08;
constexpr double kInlier_m = 0.15;         // on a surface, with noise and the thickness of walls
constexpr double kViewTolerance_m = 0.30;  // half-thickness of surfaces in view
constexpr double kSameFace = 0.70710678;   // cosine between two normals of one surface

// The reference edge that corresponds to the query's `edge`, moved to the reference frame by T;
// null without one within the gate. `along_m` gets its distance along the wall.
const WallEdge* same_edge(const Reference& reference, const WallEdge& edge, double gate_m,
                          double& along_m) {
  constexpr double kSameDirection = 0.95;  // cosine
  constexpr double kSameHeight_m = 0.03;   // and a quarter of the height
  const WallEdge* nearest = nullptr;
  double least_m = gate_m;
  for (const WallEdge& other : reference.features->edges) {
    if (edge.direction.dot(other.direction) < kSameDirection) continue;
    if (std::fabs(other.step_m - edge.step_m) > kSameHeight_m + 0.25 * other.step_m) continue;
    const Eigen::Vector2d d = edge.position_m - other.position_m;
    const double distance_m = d.dot(other.direction);
    const double across_m = d.x() * other.direction.y() - d.y() * other.direction.x();
    if (std::fabs(across_m) > kInlier_m || std::fabs(distance_m) > least_m) continue;
    least_m = std::fabs(distance_m);
    along_m = distance_m;
    nearest = &other;
  }
  return nearest;
}

// Points of a wall constrain only the distance from it, not where along the wall it steps back by 8
// cm; its edges do. Along a corridor of shut doors nothing else does.
void add_edges(const Reference& reference, const MatchFeatures& query, const Pose2& T,
               const geometry::SinCos& r, double gate_m, NormalEquations& equations) {
  for (const WallEdge& edge : query.edges) {
    const WallEdge here = moved(edge, T, r);
    double along_m = 0.0;
    const WallEdge* other = same_edge(reference, here, gate_m, along_m);
    if (other == nullptr) continue;
    const Eigen::Vector2d d = here.position_m - T.position_m();
    const Eigen::Vector2d& u = other->direction;
    const double jacobian[3] = {u.x(), u.y(), u.y() * d.x() - u.x() * d.y()};
    const double variance_m2 = 2.0 * kResidualSigma_m * kResidualSigma_m +
                               here.sigma_m * here.sigma_m + other->sigma_m * other->sigma_m;
    equations.add(jacobian, along_m, 1.0 / (variance_m2 + along_m * along_m));
    --equations.points;  // edges alone determine no pose
  }
}

NormalEquations linearize(const Reference& reference, const MatchFeatures& query, const Pose2& T,
                          double gate_m) {
  NormalEquations equations;
  const geometry::SinCos r = geometry::sincos(T.theta_rad);
  constexpr double kPerSigma2 = 1.0 / (kResidualSigma_m * kResidualSigma_m);
  for (const SurfacePoint& point : query.surface) {
    const double dx = r.cos * point.position_m.x() - r.sin * point.position_m.y();
    const double dy = r.sin * point.position_m.x() + r.cos * point.position_m.y();
    const std::int32_t found = reference.surface_grid.find(T.x_m + dx, T.y_m + dy);
    if (found == NearestPointGrid::kNone) continue;
    const SurfacePoint& other = reference.features->surface[static_cast<std::size_t>(found)];
    const double ox = T.x_m + dx - other.position_m.x();
    const double oy = T.y_m + dy - other.position_m.y();
    if (ox * ox + oy * oy > gate_m * gate_m || !other.on_line) continue;
    if (point.on_line) {  // neither two crossing walls nor both faces of one are a surface
      const double nx = r.cos * point.normal.x() - r.sin * point.normal.y();
      const double ny = r.sin * point.normal.x() + r.cos * point.normal.y();
      if (nx * other.normal.x() + ny * other.normal.y() < kSameFace) continue;
    }
    const double residual = other.normal.x() * ox + other.normal.y() * oy;
    const double u = residual / kCauchy_m;
    const double jacobian[3] = {other.normal.x(), other.normal.y(),
                                other.normal.y() * dx - other.normal.x() * dy};
    equations.add(jacobian, residual, kPerSigma2 / (1.0 + u * u));
  }
  add_edges(reference, query, T, r, gate_m, equations);
  return equations;
}

// Counts of the reference's points that are in view of the query.
struct ReverseView {
  std::size_t in_view = 0;
  std::size_t violations = 0;
};

ReverseView look_back(const Reference& reference, const MatchFeatures& query, const Pose2& T) {
  ReverseView counts;
  const Pose2 T_query_reference = geometry::inverse(T);
  const geometry::SinCos r = geometry::sincos(T_query_reference.theta_rad);
  for (const SurfacePoint& point : reference.features->surface) {
    const SurfacePoint p = moved(point, T_query_reference, r);
    const RangeProfile::View view =
        query.profile.view_of_face(p.position_m, p.normal, kViewTolerance_m);
    if (view == RangeProfile::View::kFree || view == RangeProfile::View::kSurface) ++counts.in_view;
    if (view == RangeProfile::View::kFree) ++counts.violations;
  }
  return counts;
}

// Overlap, inliers, violations and residual.
void compare_views(const Reference& reference, const MatchFeatures& query, const Pose2& T,
                   PoseEvidence& result) {
  const geometry::SinCos r = geometry::sincos(T.theta_rad);
  std::size_t in_view = 0;
  std::size_t inliers = 0;
  std::size_t violations = 0;
  double squared = 0.0;
  for (const SurfacePoint& point : query.surface) {
    const SurfacePoint here = moved(point, T, r);
    const Eigen::Vector2d& p = here.position_m;
    const std::int32_t found = reference.surface_grid.find(p.x(), p.y());
    const RangeProfile& profile = reference.features->profile;
    if (found != NearestPointGrid::kNone && !profile.turned_away(p, here.normal)) {
      const SurfacePoint& other = reference.features->surface[static_cast<std::size_t>(found)];
      const double ox = p.x() - other.position_m.x();
      const double oy = p.y() - other.position_m.y();
      const double whole2 = ox * ox + oy * oy;
      const double across = ox * other.normal.x() + oy * other.normal.y();
      const double distance2 = other.on_line ? across * across : whole2;
      if (distance2 <= kInlier_m * kInlier_m && whole2 <= 4.0 * kInlier_m * kInlier_m) {
        ++in_view;
        ++inliers;
        squared += distance2;
        continue;
      }
    }
    const RangeProfile::View view = profile.view_of_face(p, here.normal, kViewTolerance_m);
    if (view == RangeProfile::View::kFree || view == RangeProfile::View::kSurface) ++in_view;
    if (view == RangeProfile::View::kFree) ++violations;
  }
  if (query.surface.empty() || in_view == 0) return;
  const auto seen = static_cast<double>(in_view);
  result.overlap = seen / static_cast<double>(query.surface.size());
  result.inliers = static_cast<double>(inliers) / seen;
  result.violations = static_cast<double>(violations) / seen;
  const ReverseView back = look_back(reference, query, T);
  if (back.in_view > 0) {
    result.violations = std::max(result.violations, static_cast<double>(back.violations) /
                                                        static_cast<double>(back.in_view));
  }
  if (inliers > 0) result.residual_rms_m = std::sqrt(squared / static_cast<double>(inliers));
}

/// The axis of a symmetric matrix with the larger eigenvalue.
struct WidestAxis {
  double largest = 0.0;
  double smallest = 0.0;
  Eigen::Vector2d direction;  ///< of the larger one, of length 1
};

WidestAxis widest_axis(const Eigen::Matrix2d& m) {
  const double half_difference = 0.5 * (m(0, 0) - m(1, 1));
  const double mean = 0.5 * (m(0, 0) + m(1, 1));
  const double spread = std::sqrt(half_difference * half_difference + m(0, 1) * m(0, 1));
  const geometry::SinCos widest = geometry::sincos(0.5 * geometry::atan2(m(0, 1), half_difference));
  return {mean + spread, mean - spread, {widest.cos, widest.sin}};
}

// Removes the part along a direction in which the position is hardly determined. There a pull of
// centimetres would become metres, and the pose weighs nothing anyway.
Eigen::Vector2d known_part(const Eigen::Vector2d& step_m, const Eigen::Matrix2d& covariance_m2) {
  constexpr double kKnown_m2 = 0.25;
  const WidestAxis widest = widest_axis(covariance_m2);
  if (widest.largest <= kKnown_m2) return step_m;
  if (widest.smallest > kKnown_m2) return Eigen::Vector2d::Zero();
  return step_m - widest.direction * widest.direction.dot(step_m);
}

}  // namespace

Eigen::Matrix3d information_at(const Reference& reference, const MatchFeatures& query,
                               const Pose2& T_reference_query) {
  const NormalEquations equations = linearize(reference, query, T_reference_query, kGate.last_m);
  if (equations.points < kFewestPoints) return Eigen::Matrix3d::Zero();
  return equations.hessian;
}

PoseEvidence evidence_at(const Reference& reference, const MatchFeatures& query,
                         const Pose2& T_reference_query) {
  PoseEvidence evidence;
  evidence.information = information_at(reference, query, T_reference_query);
  compare_views(reference, query, T_reference_query, evidence);
  return evidence;
}

Alignment align(const Reference& reference, const MatchFeatures& query, const Pose2& T_first_guess,
                const PosePrior& prior) {
  return align_with(T_first_guess, prior, kGate, kFewestPoints, [&](const Pose2& T, double gate_m) {
    return linearize(reference, query, T, gate_m);
  });
}

PosePrior weak_prior(const PosePrior& prior) {
  // Fixed, as above. A tenth still holds what the scans do not determine: the position along a bare
  // corridor.
  constexpr double kShare = 0.1;
  return {prior.T_reference_query, kShare * prior.information};
}

Eigen::Matrix3d less_normal_errors(const Eigen::Matrix3d& information, double sigma_rad) {
  Eigen::Matrix3d known = information;
  if (!(information(2, 2) > 0.0)) return known;
  // Information of the position when the heading is free.
  const Eigen::Vector2d with_heading = information.topRightCorner<2, 1>();
  const Eigen::Matrix2d position = information.topLeftCorner<2, 2>() -
                                   with_heading * with_heading.transpose() / information(2, 2);
  const WidestAxis negative = widest_axis(-position);
  const Eigen::Vector2d& weakest = negative.direction;
  const double seeming = sigma_rad * sigma_rad * (information(0, 0) + information(1, 1));
  known.topLeftCorner<2, 2>() -=
      std::min(seeming, std::max(0.0, -negative.largest)) * weakest * weakest.transpose();
  return known;
}

Pose2 without_prior(const Pose2& T_aligned, const Eigen::Matrix3d& covariance,
                    const PosePrior& prior) {
  // Fixed: a larger step is not linear.
  constexpr double kFarthest_m = 0.3;
  constexpr double kFarthest_rad = 0.05;
  const Eigen::Vector3d pull =
      prior.information * geometry::difference(T_aligned, prior.T_reference_query);
  Eigen::Vector3d step = covariance * pull;
  step.head<2>() = known_part(step.head<2>(), covariance.topLeftCorner<2, 2>());
  if (std::fabs(step.x()) > kFarthest_m || std::fabs(step.y()) > kFarthest_m ||
      std::fabs(step.z()) > kFarthest_rad) {
    return T_aligned;
  }
  return {T_aligned.x_m + step.x(), T_aligned.y_m + step.y(),
          geometry::wrap_angle(T_aligned.theta_rad + step.z())};
}

// H (T - z) + w P (T - p) = 0 at T, H (T' - z) + P (T' - p) = 0 at T'; their difference has no z.
Pose2 with_prior(const Pose2& T_aligned, const Eigen::Matrix3d& covariance,
                 const PosePrior& prior) {
  const Eigen::Vector3d rest = (prior.information - weak_prior(prior).information) *
                               geometry::difference(T_aligned, prior.T_reference_query);
  const Eigen::Matrix3d both = covariance.inverse() + prior.information;
  const Eigen::Vector3d step = both.inverse() * rest;
  return {T_aligned.x_m - step.x(), T_aligned.y_m - step.y(),
          geometry::wrap_angle(T_aligned.theta_rad - step.z())};
}

Refinement refine(const Reference& reference, const MatchFeatures& query,
                  const Pose2& T_first_guess, const PosePrior& prior) {
  const Alignment aligned = align(reference, query, T_first_guess, prior);
  return {evidence_at(reference, query, aligned.T_reference_query), aligned.T_reference_query,
          aligned.iterations, aligned.converged};
}

bool same_place(const Pose2& a, const Pose2& b) {
  // Fixed: verdicts depend on them, and tasks do not carry them.
  constexpr double kApart_m = 0.30;
  constexpr double kApart_rad = 0.15;
  return (a.position_m() - b.position_m()).squaredNorm() <= kApart_m * kApart_m &&
         std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad)) <= kApart_rad;
}

}  // namespace topogeo::localization
