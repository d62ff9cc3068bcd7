// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/wall_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>

namespace adit {
namespace {

constexpr double kChance = 0.5;    ///< Share of equal signs that noise gives.
constexpr double kLeast = 1e-300;  ///< For logarithms.

double normal_density(double off, double sigma) {
  return std::exp(-0.5 * off * off / (sigma * sigma)) / (sigma * std::sqrt(2.0 * std::numbers::pi));
}

double density(const EqualSignShare& found, const SameWalls& walls) {
  return normal_density(found.share - walls.mean, std::hypot(walls.sigma, found.sigma));
}

/// The share that walls which give `share` under one noise give under another one. Offsets of two pairs,
/// whose common part is the relief, have the correlation rho = relief^2 / (relief^2 + noise^2) and equal
/// signs at the share 1/2 + asin(rho) / pi (Sheppard, "On the application of the theory of error", 1899).
double under_noise(double share, double from_m, double to_m) {
  if (!(from_m > 0.0 && to_m > 0.0)) return share;
  constexpr double kNearlyOne = 0.999;
  const double rho = std::min(std::sin(std::numbers::pi * (share - kChance)), kNearlyOne);
  const double ratio = rho / (1.0 - rho) * std::pow(from_m / to_m, 2);
  return kChance + std::asin(ratio / (1.0 + ratio)) / std::numbers::pi;
}

/// Averages over the distribution of `walls` by steps in its standard deviation.
double density(const EqualSignShare& found, const OtherWalls& walls) {
  constexpr double kStep = 0.1;  // sigmas
  constexpr int kSteps = 60;     // to each side
  double sum = 0.0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double share =
        kChance + std::min(std::exp(walls.mean_log + kStep * i * walls.sigma_log), 1.0 - kChance);
    sum += kStep * normal_density(kStep * i, 1.0) * normal_density(found.share - share, found.sigma);
  }
  return sum;
}

/// A normal distribution by some of its values, to 2.4 standard deviations on each side (98 % of it).
struct NormalNode {
  double value = 0.0;
  double chance = 0.0;
};
const std::array<NormalNode, 13>& normal_nodes() {
  static const auto kNodes = [] {
    constexpr double kStep = 0.4;
    std::array<NormalNode, 13> nodes;
    double sum = 0.0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      nodes[i].value = kStep * (static_cast<double>(i) - 6.0);
      nodes[i].chance = normal_density(nodes[i].value, 1.0);
      sum += nodes[i].chance;
    }
    for (NormalNode& node : nodes) node.chance /= sum;
    return nodes;
  }();
  return kNodes;
}

/// The logarithm of a sum of chances times likelihoods.
class LogMixture {
 public:
  void add(double chance, double log_likelihood) {
    if (!(chance > 0.0)) return;
    const double log = std::log(chance) + log_likelihood;
    const double larger = std::max(value_, log);
    value_ = larger + std::log(std::exp(value_ - larger) + std::exp(log - larger));
  }
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_ = -std::numeric_limits<double>::infinity();
};

/// Log likelihood of all stretches, each by itself; `times`: as if there were so many times as many.
template <class Likelihood>
double log_of_all(const std::vector<StretchSigns>& stretches, double times, const Likelihood& likelihood) {
  constexpr double kFew = 2.0;  // signs, whose share says little
  double sum = 0.0;
  for (const StretchSigns& one : stretches)
    // No share is known better, even where all signs are equal.
    if (one.num >= kFew) sum += std::log(std::max(likelihood(one.share(), 0.5 / std::sqrt(one.num)), kLeast));
  return times * sum;
}

/// Of the share of a wall that was moved: anything from that of noise to all.
double density_if_moved(double share, double sigma) {
  constexpr int kParts = 10;
  double sum = 0.0;
  for (int i = 0; i < kParts; ++i)
    sum += normal_density(share - (kChance + (i + 0.5) * (1.0 - kChance) / kParts), sigma);
  return sum / kParts;
}

/// Between two visits nothing was moved, or a part of the stretches. The share on the own map only bounds
/// what one wall gives: what makes signs equal there, leaves and edges, may be missing between two maps.
double log_of_same(const std::vector<StretchSigns>& stretches, const SameWalls& same,
                   const ReliefModel& model, double times) {
  constexpr int kMeans = 3;
  LogMixture all;
  for (int i = 0; i < kMeans; ++i) {
    const double mean = kChance + (same.mean - kChance) * i / (kMeans - 1);
    const auto unless_moved = [&](double moved) {
      return log_of_all(stretches, times, [&](double share, double sigma) {
        return (1.0 - moved) * normal_density(share - mean, std::hypot(sigma, same.sigma)) +
               moved * density_if_moved(share, sigma);
      });
    };
    all.add((1.0 - model.lined_anew) / kMeans, unless_moved(0.0));
    all.add(model.lined_anew / kMeans, unless_moved(model.lined_share));
  }
  return all.value();
}

/// Relief varies along a tunnel, about a mean that varies from tunnel to tunnel.
double log_of_other(const std::vector<StretchSigns>& stretches, const OtherWalls& other, double stretch_sigma,
                    double times) {
  LogMixture all;
  for (const NormalNode& of_tunnel : normal_nodes()) {
    std::array<double, 13> shares{};
    for (std::size_t i = 0; i < shares.size(); ++i)
      shares[i] =
          kChance + std::min(1.0 - kChance, std::exp(other.mean_log + other.sigma_log * of_tunnel.value +
                                                     stretch_sigma * normal_nodes()[i].value));
    all.add(of_tunnel.chance, log_of_all(stretches, times, [&](double share, double sigma) {
              double sum = 0.0;
              for (std::size_t i = 0; i < shares.size(); ++i)
                sum += normal_nodes()[i].chance * normal_density(share - shares[i], sigma);
              return sum;
            }));
  }
  return all.value();
}

}  // namespace

void EqualSignShares::set_same(const EqualSignShare& share) {
  same_ = share;
  forget_what_follows();
}

void EqualSignShares::add_other(const EqualSignShare& share) {
  if (share.num_patches < static_cast<std::size_t>(model_.few_patches)) return;
  others_.push_back(share);
  forget_what_follows();
}

void EqualSignShares::forget_what_follows() {
  chances_.reset();
  answers_.clear();
}

SameWalls EqualSignShares::same() const {
  SameWalls walls{model_.same_share, model_.same_sigma};
  if (same_.num_patches >= static_cast<std::size_t>(model_.few_patches))
    walls.mean = std::max(walls.mean, same_.share);
  return walls;
}

const std::vector<double>& EqualSignShares::chances_to_be_the_same() const {
  if (!chances_) chances_ = estimated_chances();
  return *chances_;
}

std::vector<double> EqualSignShares::estimated_chances() const {
  constexpr int kRounds = 50;  // of expectation and maximisation, which settle within ten or so
  std::vector<double> ratios;  // of likelihoods, the same walls to others
  for (const EqualSignShare& one : others_) {
    const double of_same = density(one, same());
    ratios.push_back(of_same > 0.0 ? of_same / density(one, believed(one.noise_m)) : 0.0);
  }
  std::vector<double> chances(others_.size());
  double rate = model_.prior_moulded;
  for (int round = 0; round < kRounds; ++round) {
    double num_same = model_.prior_moulded;
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      const double odds = ratios[i] * rate / (1.0 - rate);
      chances[i] = std::isfinite(odds) ? odds / (1.0 + odds) : 1.0;
      num_same += chances[i];
    }
    rate = num_same / (1.0 + static_cast<double>(ratios.size()));
  }
  return chances;
}

double EqualSignShares::chance_of_one_mould() const {
  if (others_.empty()) return model_.prior_moulded;
  const std::vector<double>& chances = chances_to_be_the_same();
  const double num_same = std::accumulate(chances.begin(), chances.end(), 0.0);
  return std::min(1.0, model_.moulded + num_same / (1.0 + static_cast<double>(chances.size())));
}

double EqualSignShares::evidence(const EqualSignShare& found, double times,
                                 const std::vector<EqualSignShare>& elsewhere) const {
  constexpr std::size_t kKept = 16;
  if (times * static_cast<double>(found.num_patches) < model_.min_patches) return 0.0;
  const auto known = std::ranges::find_if(answers_, [&](const Answer& one) {
    return one.times == times && one.found == found && one.elsewhere == elsewhere;
  });
  if (known != answers_.end()) return known->evidence;
  if (answers_.size() == kKept) answers_.erase(answers_.begin());
  const double weight = elsewhere.empty() ? weighed(found, times) : beside(elsewhere).weighed(found, times);
  return answers_.emplace_back(Answer{found, elsewhere, times, weight}).evidence;
}

EqualSignShares EqualSignShares::beside(const std::vector<EqualSignShare>& elsewhere) const {
  EqualSignShares all(model_);
  all.same_ = same_;
  all.others_ = others_;
  std::ranges::copy_if(elsewhere, std::back_inserter(all.others_), [&](const EqualSignShare& share) {
    return share.num_patches >= static_cast<std::size_t>(model_.min_patches);
  });
  return all;
}

double EqualSignShares::weighed(const EqualSignShare& found, double times) const {
  const double of_same = log_of_same(found.stretches, same(), model_, times);
  const double of_other = log_of_other(
      found.stretches, other(found.noise_m).value_or(believed(found.noise_m)), model_.stretch_sigma, times);
  const auto mixed = [&](double chance_of_other) {
    LogMixture both;
    both.add(1.0 - chance_of_other, of_same);
    both.add(chance_of_other, of_other);
    return both.value();
  };
  return mixed(model_.changed) - mixed(1.0 - chance_of_one_mould());
}

double EqualSignShares::most_evidence(const std::vector<EqualSignShare>& elsewhere) const {
  return std::log(1.0 / beside(elsewhere).chance_of_one_mould());
}

OtherWalls EqualSignShares::believed(double noise_m) const {
  return {std::log(under_noise(model_.prior_other_share, same_.noise_m, noise_m) - kChance),
          model_.prior_sigma};
}

std::optional<OtherWalls> EqualSignShares::other(double noise_m) const {
  constexpr double kFewest = 0.5;  // look-alikes that were seen to be others, in expectation
  struct Beyond {
    double weight;  // P(the walls are others)
    double log;     // of the share beyond one half
    double sigma;   // of that logarithm
  };
  std::vector<Beyond> all;
  double num = 0.0;
  double mean = 0.0;
  const std::vector<double>& chances = chances_to_be_the_same();
  for (std::size_t i = 0; i < others_.size(); ++i) {
    const EqualSignShare& one = others_[i];
    // No share is known to be nearer to one half than its error.
    const double least = kChance + std::max(one.share - kChance, one.sigma);
    const double beyond = under_noise(least, one.noise_m, noise_m) - kChance;
    const double weight = 1.0 - chances[i];
    all.push_back({weight, std::log(beyond), one.sigma / beyond});
    num += weight;
    mean += weight * all.back().log;
  }
  if (num < kFewest) return {};
  mean /= num;
  double beyond_chance = model_.prior_stretches * model_.prior_sigma * model_.prior_sigma;
  for (const Beyond& one : all)
    beyond_chance += one.weight * std::max(0.0, std::pow(one.log - mean, 2) - one.sigma * one.sigma);
  const double variance = beyond_chance / std::max(model_.prior_stretches + num - 1.0, kFewest);
  return OtherWalls{mean, std::sqrt(variance * (1.0 + 1.0 / num))};
}

}  // namespace adit
