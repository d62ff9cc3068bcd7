// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/control_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/geometry/umeyama.hpp"

namespace adit {
namespace {

using Eigen::Index;
using Points = std::vector<std::size_t>;  // ascending

constexpr std::size_t kMostTriples = 3000;

Index at(std::size_t i) { return 3 * static_cast<Index>(i); }

/// Some of the points, fitted.
struct Fitted {
  Points points;
  Pose T;                     // of the centred target
  Matrix6 covariance;         // right perturbation
  Eigen::MatrixXd gain;       // 6 x 3k
  Eigen::MatrixXd precision;  // P of the residuals: chi2 = r^T P r for whatever r the best pose leaves
  Eigen::VectorXd residuals;  // 3k
  double chi2 = 0.0;

  [[nodiscard]] double worst_rotation() const {
    const Matrix3 of_rotation = covariance.bottomRightCorner<3, 3>();
    return std::sqrt(std::max(0.0, symmetric_eigen(of_rotation).values[2]));
  }
  [[nodiscard]] bool is_known() const {
    return covariance.allFinite() && worst_rotation() <= kWorstControlRotation;
  }
  [[nodiscard]] bool is_upright() const { return T.rotation_matrix()(2, 2) > std::cos(kMostControlTilt); }
};

/// What all fits share.
class ControlSolver {
 public:
  explicit ControlSolver(const ControlPairs& pairs) : pairs_(pairs) {
    // National coordinates would cost digits.
    for (const Vector3& target : pairs.target) centre_ += target / static_cast<double>(pairs.target.size());
    for (const Vector3& target : pairs.target) target_.push_back(target - centre_);
  }

  [[nodiscard]] const ControlPairs& pairs() const { return pairs_; }
  [[nodiscard]] Pose in_target_frame(const Pose& T) const {
    return {T.rotation(), T.translation() + centre_};
  }
  [[nodiscard]] Vector3 residual(const Pose& T, std::size_t i) const {
    return target_[i] - T * pairs_.source[i];
  }

  /// From where a rigid alignment without weights starts. None where the points leave the pose open.
  [[nodiscard]] std::optional<Fitted> fit(const Points& points) const {
    std::vector<Vector3> source;
    std::vector<Vector3> target;
    for (const std::size_t i : points) {
      source.push_back(pairs_.source[i]);
      target.push_back(target_[i]);
    }
    const Result<Pose> start = align_rigid(source, target);
    if (!start) return std::nullopt;
    return fit(points, *start);
  }
  [[nodiscard]] std::optional<Fitted> fit(const Points& points, Pose T) const {
    constexpr int kMostSteps = 20;
    for (int step = 0; step < kMostSteps; ++step) {
      std::optional<Fitted> fitted = linearized(points, T);
      if (!fitted) return std::nullopt;
      const Vector6 change = fitted->gain * fitted->residuals;
      if (!change.allFinite()) return std::nullopt;
      if (change.head<3>().norm() < 1e-7 && change.tail<3>().norm() < 1e-10) return fitted;
      T = T * Pose::exp(change);
    }
    return std::nullopt;
  }

  /// The misfits of the points of a fit, in their order: prediction by all others, see the header.
  [[nodiscard]] static std::vector<std::optional<double>> misfits(const Fitted& fitted) {
    std::vector<std::optional<double>> out;
    const Eigen::VectorXd weighted = fitted.precision * fitted.residuals;
    for (std::size_t k = 0; k < fitted.points.size(); ++k)
      out.push_back(misfit(fitted.precision.block<3, 3>(at(k), at(k)), weighted.segment<3>(at(k))));
    return out;
  }
  /// Of one more point, which the fit does not use.
  [[nodiscard]] std::optional<double> misfit_of(const Fitted& fitted, std::size_t point) const {
    Points with = fitted.points;
    with.insert(std::ranges::lower_bound(with, point), point);
    const std::optional<Fitted> together = linearized(with, fitted.T);
    if (!together) return std::nullopt;
    const auto k = static_cast<std::size_t>(std::ranges::lower_bound(with, point) - with.begin());
    const Eigen::VectorXd weighted = together->precision * together->residuals;
    return misfit(together->precision.block<3, 3>(at(k), at(k)), weighted.segment<3>(at(k)));
  }

 private:
  /// e^T C^-1 e of the error e = P_kk^-1 (P r)_k, with the covariance C = P_kk^-1; along directions that the
  /// others leave open P_kk is zero, and so is (P r)_k.
  static std::optional<double> misfit(const Matrix3& precision, const Vector3& weighted) {
    constexpr double kOpen = 1e-9;
    const auto [values, vectors] = symmetric_eigen(precision);
    if (!(values[0] > kOpen * values[2])) return std::nullopt;
    double squared = 0.0;
    for (Index axis = 0; axis < 3; ++axis)
      squared += std::pow(vectors.col(axis).dot(weighted), 2) / values[axis];
    return squared;
  }

  [[nodiscard]] Eigen::MatrixXd covariance_of(const Points& points, const Matrix3& rotation) const {
    Eigen::MatrixXd out(at(points.size()), at(points.size()));
    for (std::size_t a = 0; a < points.size(); ++a)
      for (std::size_t b = 0; b < points.size(); ++b)
        out.block<3, 3>(at(a), at(b)) = rotation *
                                        pairs_.source_covariance.block<3, 3>(at(points[a]), at(points[b])) *
                                        rotation.transpose();
    for (std::size_t a = 0; a < points.size(); ++a)
      out.diagonal().segment<3>(at(a)) += pairs_.target_sigma[points[a]].cwiseAbs2();
    return out;
  }

  /// All but the pose of a fit, at T.
  [[nodiscard]] std::optional<Fitted> linearized(const Points& points, const Pose& T) const {
    const Matrix3 rotation = T.rotation_matrix();
    Fitted out{points, T, {}, {}, {}, Eigen::VectorXd(at(points.size())), 0.0};
    Eigen::MatrixXd J(at(points.size()), 6);
    for (std::size_t k = 0; k < points.size(); ++k) {
      J.block<3, 3>(at(k), 0) = rotation;
      J.block<3, 3>(at(k), 3) = -rotation * so3::hat(pairs_.source[points[k]]);
      out.residuals.segment<3>(at(k)) = residual(T, points[k]);
    }
    const Eigen::LLT<Eigen::MatrixXd> covariance(covariance_of(points, rotation));
    if (covariance.info() != Eigen::Success) return std::nullopt;
    const Eigen::MatrixXd weighted_J = covariance.solve(J);
    const std::optional<Matrix6> pose = inverse_of_positive_definite(Matrix6(J.transpose() * weighted_J));
    if (!pose || !pose->allFinite()) return std::nullopt;
    out.covariance = *pose;
    out.gain = *pose * weighted_J.transpose();
    out.precision = covariance.solve(Eigen::MatrixXd::Identity(J.rows(), J.rows())) - weighted_J * out.gain;
    out.chi2 = out.residuals.dot(out.precision * out.residuals);
    return out;
  }

  const ControlPairs& pairs_;
  Vector3 centre_ = Vector3::Zero();
  std::vector<Vector3> target_;  // less centre_
};

bool agrees(const std::optional<double>& misfit) { return misfit && *misfit <= kControlBound; }

std::vector<Points> triples_of(const Points& control) {
  const std::size_t n = control.size();
  std::vector<Points> out;
  if (n * (n - 1) * (n - 2) / 6 <= kMostTriples) {
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b)
        for (std::size_t c = b + 1; c < n; ++c) out.push_back({control[a], control[b], control[c]});
    return out;
  }
  Rng rng(n);
  while (out.size() < kMostTriples) {
    Points triple = {control[rng.below(n)], control[rng.below(n)], control[rng.below(n)]};
    std::ranges::sort(triple);
    if (triple[0] != triple[1] && triple[1] != triple[2]) out.push_back(std::move(triple));
  }
  return out;
}

/// Three points that agree, and who else agrees with them.
struct Consensus {
  Points points;
  double cost = 0.0;  // truncated chi2 of all control points
};

/// What the triples say.
struct Search {
  std::vector<Consensus> found;
  double best_rotation =
      std::numeric_limits<double>::infinity();  // radians, of the triple that knows it best
};

Search search(const ControlSolver& solver, const Points& control) {
  Search out;
  for (const Points& triple : triples_of(control)) {
    const std::optional<Fitted> fitted = solver.fit(triple);
    if (!fitted) continue;
    out.best_rotation = std::min(out.best_rotation, fitted->worst_rotation());
    if (!fitted->is_known() || !fitted->is_upright() || fitted->chi2 > kControlBound) continue;
    Consensus consensus{triple, fitted->chi2};
    for (const std::size_t point : control) {
      if (std::ranges::find(triple, point) != triple.end()) continue;
      const std::optional<double> misfit = solver.misfit_of(*fitted, point);
      consensus.cost += agrees(misfit) ? *misfit : kControlBound;
      if (agrees(misfit)) consensus.points.push_back(point);
    }
    std::ranges::sort(consensus.points);
    out.found.push_back(std::move(consensus));
  }
  return out;
}

/// Points leave and enter one at a time, the worst and the best first.
std::optional<Fitted> settled(const ControlSolver& solver, const Points& control, Points points) {
  std::optional<Fitted> fitted = solver.fit(points);
  for (std::size_t step = 0; fitted && step < 2 * control.size(); ++step) {
    const std::vector<std::optional<double>> misfits = ControlSolver::misfits(*fitted);
    const auto worst = std::ranges::max_element(misfits);
    if (points.size() > 3 && *worst && !agrees(*worst)) {
      points.erase(points.begin() + (worst - misfits.begin()));
    } else {
      std::optional<std::size_t> next;
      double least = kControlBound;
      for (const std::size_t point : control) {
        if (std::ranges::binary_search(points, point)) continue;
        const std::optional<double> misfit = solver.misfit_of(*fitted, point);
        if (!misfit || *misfit > least) continue;
        least = *misfit;
        next = point;
      }
      if (!next) return fitted;
      points.insert(std::ranges::lower_bound(points, *next), *next);
    }
    fitted = solver.fit(points, fitted->T);
  }
  return fitted;
}

std::string names_of(const ControlPairs& pairs, const Points& points) {
  std::vector<std::string> names;
  for (const std::size_t i : points) names.push_back(pairs.names[i]);
  return format("{}", fmt::join(names, ", "));
}

/// A group as large as `chosen`, of which it shares less than what fixes a pose.
const Consensus* rival_of(const Points& chosen, const std::vector<Consensus>& found) {
  const auto is_rival = [&](const Consensus& other) {
    Points in_both;
    std::ranges::set_intersection(other.points, chosen, std::back_inserter(in_both));
    return other.points.size() >= chosen.size() && in_both.size() < 3;
  };
  const auto rival = std::ranges::find_if(found, is_rival);
  return rival == found.end() ? nullptr : &*rival;
}

bool would_fit_exchanged(ControlPairs pairs, const Points& control) {
  for (Vector3& target : pairs.target) std::swap(target.x(), target.y());
  const Search exchanged = search(ControlSolver(pairs), control);
  return std::ranges::any_of(exchanged.found, [&](const Consensus& consensus) {
    return consensus.points.size() >= 4 || consensus.points.size() == control.size();
  });
}

tl::unexpected<Error> nothing_agrees(const ControlPairs& pairs, const Points& control, const Search& found) {
  if (!(found.best_rotation <= kWorstControlRotation)) {
    const std::string known = std::isfinite(found.best_rotation)
                                  ? format("known to {:.0f} degrees only", found.best_rotation / kDegree)
                                  : "open";
    return fail(format(
        "the control points {} lie on one line or near it, so that the rotation about it is {}; measure "
        "one more well off that line",
        names_of(pairs, control), known));
  }
  const std::string exchanged = would_fit_exchanged(pairs, control)
                                    ? "; with x and y exchanged they agree: x has to be the easting"
                                    : "";
  return fail(
      format("no three of the control points {} agree: distances between them differ from those in the map "
             "by more than their standard deviations allow (0.1 % of sound points would), or the map would "
             "not stand "
             "upright{}",
             names_of(pairs, control), exchanged));
}

ControlFit control_fit_of(const ControlSolver& solver, const Fitted& fitted) {
  const ControlPairs& pairs = solver.pairs();
  const std::size_t num = pairs.target.size();
  ControlFit out;
  out.T_target_source = solver.in_target_frame(fitted.T);
  out.covariance = fitted.covariance;
  out.used.resize(num, false);
  out.gain = Eigen::MatrixXd::Zero(6, at(num));
  out.misfits.resize(num);
  out.chi2 = fitted.chi2;
  out.redundancy = static_cast<int>(at(fitted.points.size())) - 6;
  const std::vector<std::optional<double>> own = ControlSolver::misfits(fitted);
  Vector3 centre = Vector3::Zero();
  for (std::size_t k = 0; k < fitted.points.size(); ++k) {
    const std::size_t i = fitted.points[k];
    out.used[i] = true;
    out.misfits[i] = own[k];
    out.gain.middleCols<3>(at(i)) = fitted.gain.middleCols<3>(at(k));
    centre += pairs.source[i] / static_cast<double>(fitted.points.size());
  }
  Eigen::VectorXd stretched(at(fitted.points.size()));
  for (std::size_t k = 0; k < fitted.points.size(); ++k)
    stretched.segment<3>(at(k)) = fitted.T.rotation() * (pairs.source[fitted.points[k]] - centre);
  const Eigen::VectorXd weighted = fitted.precision * stretched;
  const double precision = stretched.dot(weighted);
  out.scale = 1.0 + weighted.dot(fitted.residuals) / precision;
  out.scale_sigma = 1.0 / std::sqrt(precision);
  for (std::size_t i = 0; i < num; ++i) {
    out.residuals.push_back(solver.residual(fitted.T, i));
    if (!out.used[i]) out.misfits[i] = solver.misfit_of(fitted, i);
  }
  return out;
}

}  // namespace

Result<ControlFit> fit_control(const ControlPairs& pairs) {
  const std::size_t num = pairs.target.size();
  ADIT_CHECK(pairs.names.size() == num && pairs.target_sigma.size() == num && pairs.source.size() == num &&
                 pairs.is_check.size() == num && pairs.source_covariance.rows() == at(num) &&
                 pairs.source_covariance.cols() == at(num),
             "everything of each point");
  Points control;
  for (std::size_t i = 0; i < num; ++i)
    if (!pairs.is_check[i]) control.push_back(i);
  if (control.size() < 3)
    return fail(format("{} control point{}, and three that are not on one line are needed; measure more",
                       control.size(), control.size() == 1 ? "" : "s"));
  const ControlSolver solver(pairs);
  const Search searched = search(solver, control);
  // Along a line many points may fix together what no three of them do.
  const bool together = searched.found.empty() && searched.best_rotation > kWorstControlRotation;
  if (searched.found.empty() && !together) return nothing_agrees(pairs, control, searched);
  const std::optional<Fitted> fitted = settled(
      solver, control, together ? control : std::ranges::min(searched.found, {}, &Consensus::cost).points);
  if (!fitted || !fitted->is_known() || !fitted->is_upright())
    return nothing_agrees(pairs, control, searched);
  if (const Consensus* rival = rival_of(fitted->points, searched.found)) {
    Points in_one;
    std::ranges::set_symmetric_difference(fitted->points, rival->points, std::back_inserter(in_one));
    return fail(format(
        "the control points {} agree with one another, and so do {}, but not all of them together: one "
        "of {} is wrong and nothing tells which; measure one more point",
        names_of(pairs, fitted->points), names_of(pairs, rival->points), names_of(pairs, in_one)));
  }
  return control_fit_of(solver, *fitted);
}

}  // namespace adit
