// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/sensor_difference.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "adit/core/angles.hpp"

namespace adit {
namespace {

constexpr double kNodeSpacing = 4.0 * kDegree;
constexpr double kLastNode = 2.0 * kElevationNodesToEachSide;

/// What one sensor saw of a wall.
struct View {
  Eigen::Vector3f towards;  // from the wall to the sensor,
  Eigen::Vector3f up;       // whose robot stands upright along this
  float intensity;
};

/// A range that is too long by e moves the wall back by e times the cosine of incidence.
void add_view(const View& view, const Eigen::Vector3f& normal, double weight,
              Eigen::Ref<Eigen::Matrix<double, kErrorsOfSensor, 1>> sum, double& known) {
  const Eigen::Vector3f direction = view.towards.normalized();
  const auto cosine = static_cast<double>(std::abs(normal.dot(direction)));
  const auto elevation = static_cast<double>(std::asin(std::clamp(-direction.dot(view.up), -1.0F, 1.0F)));
  const double place =
      std::clamp(elevation / kNodeSpacing + kElevationNodesToEachSide, 0.0, kLastNode - 1e-9);
  const auto node = static_cast<Eigen::Index>(place);
  const double beyond = place - static_cast<double>(node);
  const double moved = weight * cosine;
  sum[kConstantError] += moved;
  sum[kIncidenceError] += moved * (1.0 - cosine);
  if (view.intensity > 0.0F && std::isfinite(view.intensity)) {
    sum[kIntensityError] += moved * std::log10(static_cast<double>(view.intensity));
    known += moved;
  }
  sum[kFirstElevationError + node] += moved * (1.0 - beyond);
  sum[kFirstElevationError + node + 1] += moved * beyond;
}

Eigen::VectorXd prior_weights(const OffsetPrior& prior) {
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(kSensorErrors, 1.0 / (prior.ring_m * prior.ring_m));
  for (const int first : {0, kErrorsOfSensor}) {
    weights[first + kConstantError] = 1.0 / (prior.bias_m * prior.bias_m);
    weights[first + kIncidenceError] = 1.0 / (prior.walk_m * prior.walk_m);
    weights[first + kIntensityError] = 1.0 / (prior.per_tenfold_m * prior.per_tenfold_m);
  }
  return weights;
}

/// The rows of one pair of scans, and its errors of fit eliminated from the normal equations of the sensors.
struct EliminatedFit {
  Eigen::Index first;
  Eigen::Index num;
  Eigen::LDLT<Matrix6> H;
  Eigen::Matrix<double, 6, kSensorErrors> with_sensors;
  Vector6 rhs;
};

/// Weighted least squares; each fit belongs to few rows, so that the sensors alone are left to solve for.
OffsetParts solved(const OffsetSystem& offsets, const Eigen::VectorXd& weights, const OffsetPrior& prior) {
  Vector6 fit_prior;
  fit_prior << Vector3::Constant(1.0 / (prior.fit_m * prior.fit_m)),
      Vector3::Constant(1.0 / (prior.fit_rad * prior.fit_rad));
  const Eigen::MatrixXd weighted = offsets.by_sensors.transpose() * weights.asDiagonal();
  Eigen::MatrixXd H = weighted * offsets.by_sensors;
  Eigen::VectorXd rhs = weighted * offsets.metres;
  H.diagonal() += prior_weights(prior);
  std::vector<EliminatedFit> fits;
  for (std::size_t pair = 0; pair < offsets.first_of_pair.size(); ++pair) {
    const Eigen::Index first = offsets.first_of_pair[pair];
    const Eigen::Index end =
        pair + 1 < offsets.first_of_pair.size() ? offsets.first_of_pair[pair + 1] : offsets.metres.size();
    const auto motion = offsets.by_fit.middleRows(first, end - first);
    const Eigen::MatrixXd of_pair = motion.transpose() * weights.segment(first, end - first).asDiagonal();
    Matrix6 of_fit = of_pair * motion;
    of_fit.diagonal() += fit_prior;
    EliminatedFit& fit = fits.emplace_back(EliminatedFit{
        first, end - first, of_fit.ldlt(), of_pair * offsets.by_sensors.middleRows(first, end - first),
        of_pair * offsets.metres.segment(first, end - first)});
    H -= fit.with_sensors.transpose() * fit.H.solve(fit.with_sensors);
    rhs -= fit.with_sensors.transpose() * fit.H.solve(fit.rhs);
  }
  const Eigen::VectorXd errors = H.llt().solve(rhs);
  OffsetParts parts{offsets.by_sensors * errors, {}};
  parts.left = offsets.metres - parts.by_sensors;
  for (const EliminatedFit& fit : fits)
    parts.left.segment(fit.first, fit.num) -=
        offsets.by_fit.middleRows(fit.first, fit.num) * fit.H.solve(fit.rhs - fit.with_sensors * errors);
  return parts;
}

/// Of a normal distribution, from the median of absolute values.
double robust_sigma(const Eigen::Ref<const Eigen::VectorXd>& residuals) {
  constexpr double kOfMedian = 1.4826;
  constexpr double kLeast = 1e-4;
  std::vector<double> sizes(residuals.data(), residuals.data() + residuals.size());
  for (double& size : sizes) size = std::abs(size);
  const auto middle = sizes.begin() + std::ssize(sizes) / 2;
  std::ranges::nth_element(sizes, middle);
  return std::max(kOfMedian * *middle, kLeast);
}

/// Of one row; 0 where none is repeated.
double noise_of(const Eigen::VectorXd& left, const std::vector<std::array<Eigen::Index, 2>>& repeated) {
  if (repeated.empty()) return 0.0;
  Eigen::VectorXd apart(std::ssize(repeated));
  for (Eigen::Index i = 0; i < apart.size(); ++i) {
    const auto& [first, second] = repeated[static_cast<std::size_t>(i)];
    apart[i] = left[first] - left[second];
  }
  return robust_sigma(apart / std::numbers::sqrt2);
}

constexpr double kTukey = 4.685;  // sigmas: 95 % efficient where errors are normal

/// Beyond kTukey it is 0: walls that were moved are nothing.
double tukey_weight(double sigmas) { return std::pow(std::max(0.0, 1.0 - std::pow(sigmas / kTukey, 2)), 2); }

/// For each stretch what its rows weigh, by how far its mean is off among the means of all.
std::vector<double> weights_of_stretches(const Eigen::VectorXd& left,
                                         const std::vector<std::size_t>& stretches, double noise_m) {
  constexpr std::size_t kFewest = 8;    // stretches, or rows of one: fewer do not show how far means are off
  constexpr double kLeast = 1.0 / 3.0;  // of the noise: smaller means do not change signs
  struct Sum {
    double metres = 0.0;
    double num = 0.0;
    [[nodiscard]] double mean() const { return metres / num; }
  };
  std::vector<Sum> sums(stretches.empty() ? 0 : 1 + std::ranges::max(stretches));
  for (std::size_t row = 0; row < stretches.size(); ++row) {
    sums[stretches[row]].metres += left[static_cast<Eigen::Index>(row)];
    ++sums[stretches[row]].num;
  }
  std::vector<double> means;
  for (const Sum& sum : sums)
    if (sum.num >= static_cast<double>(kFewest)) means.push_back(sum.mean());
  std::vector<double> weights(sums.size(), 1.0);
  if (means.size() < kFewest) return weights;
  const double spread = robust_sigma(Eigen::Map<const Eigen::VectorXd>(means.data(), std::ssize(means)));
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double of_mean = std::hypot(spread, noise_m / std::sqrt(sums[i].num));
    weights[i] = tukey_weight(sums[i].mean() / std::max(kLeast * noise_m, of_mean));
  }
  return weights;
}

}  // namespace

SensorTermsOf::SensorTermsOf(const SearchableSurface& a, const SearchableSurface& b, const Pose& T_a_b)
    : viewpoint_a_(a.viewpoint()),
      viewpoint_b_((T_a_b * b.viewpoint().cast<double>()).cast<float>()),
      up_a_(Eigen::Vector3f::UnitZ()),
      up_b_(T_a_b.rotation_matrix().col(2).cast<float>()) {}

void SensorTermsOf::add(const WallPair& pair, double weight, SensorTerms& sum, Eigen::Vector2d& known) const {
  add_view({viewpoint_a_ - pair.seen_by_a, up_a_, pair.intensity_a}, pair.normal, weight,
           sum.head<kErrorsOfSensor>(), known[0]);
  add_view({viewpoint_b_ - pair.seen_by_b, up_b_, pair.intensity_b}, pair.normal, -weight,
           sum.tail<kErrorsOfSensor>(), known[1]);
}

void centre_intensities(Eigen::Matrix<double, Eigen::Dynamic, kSensorErrors>& by_sensors,
                        const Eigen::Matrix<double, Eigen::Dynamic, 2>& known) {
  for (const Eigen::Index sensor : {0, 1}) {
    auto logarithms = by_sensors.col(sensor * kErrorsOfSensor + kIntensityError);
    const double num = known.col(sensor).sum();
    if (num != 0.0) logarithms -= logarithms.sum() / num * known.col(sensor);
  }
}

Vector6 motion_terms(const WallPair& pair) {
  const Vector3 normal = pair.normal.cast<double>();
  Vector6 terms;
  terms << normal, pair.seen_by_b.cast<double>().cross(normal);
  return terms;
}

Fields fields_of(OffsetPrior& c) {
  return {{"bias_m", &c.bias_m, "m", 1e-6, 10.0, "range by which two sensors differ, the same everywhere"},
          {"walk_m", &c.walk_m, "m", 1e-6, 10.0, "the same at grazing incidence, on top"},
          {"per_tenfold_m", &c.per_tenfold_m, "m", 1e-6, 10.0,
           "between two returns, one ten times as intense as the other"},
          {"ring_m", &c.ring_m, "m", 1e-6, 10.0, "range by elevation, at each node"},
          {"fit_m", &c.fit_m, "m", 1e-6, 10.0, "error of the fit of two scans, along each axis"},
          {"fit_rad", &c.fit_rad, "rad", 1e-6, 1.0, "the same, about each axis"}};
}

OffsetParts taken_apart(const OffsetSystem& offsets, const OffsetPrior& prior) {
  constexpr int kRounds = 5;
  constexpr double kHuber = 1.345;  // sigmas, as efficient as kTukey
  constexpr std::size_t kFew = 20;  // repeated patches, whose median says little
  OffsetParts parts{Eigen::VectorXd::Zero(offsets.metres.size()), offsets.metres};
  if (offsets.metres.size() == 0) return parts;
  std::vector<double> of_stretches;
  for (int round = 0; round < 2 * kRounds; ++round) {
    const double sigma =
        offsets.repeated.size() > kFew ? noise_of(parts.left, offsets.repeated) : robust_sigma(parts.left);
    const Eigen::ArrayXd off = parts.left.array().abs() / sigma;
    const Eigen::ArrayXd huber = (kHuber * off.max(1e-12).inverse()).min(1.0);
    Eigen::VectorXd weights = (round < kRounds ? huber : off.unaryExpr(&tukey_weight)) / (sigma * sigma);
    // At first all is off by what the fit will explain.
    if (round > 0) of_stretches = weights_of_stretches(parts.left, offsets.stretches, sigma);
    if (!of_stretches.empty())
      for (Eigen::Index row = 0; row < weights.size(); ++row)
        weights[row] *= of_stretches[offsets.stretches[static_cast<std::size_t>(row)]];
    parts = solved(offsets, weights, prior);
  }
  parts.noise_m = noise_of(parts.left, offsets.repeated);
  parts.is_moved.assign(static_cast<std::size_t>(offsets.metres.size()), false);
  for (std::size_t row = 0; row < offsets.stretches.size(); ++row)
    parts.is_moved[row] = of_stretches[offsets.stretches[row]] == 0.0;
  return parts;
}

}  // namespace adit
