// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <Eigen/Cholesky>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "adit/core/format.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/registration/registration.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

struct RegisterOptions {
  std::string cloud_a;
  std::string cloud_b;
};

/// Row by row; null where there is no answer.
template <class Matrix>
nlohmann::ordered_json rows_of(const Matrix& matrix) {
  nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) numbers.push_back(matrix(row, column));
  }
  return numbers;
}

nlohmann::ordered_json json_of(const Registration& r, double time_s) {
  return {{"T_a_b", r.T_a_b ? rows_of(r.T_a_b->matrix()) : nlohmann::ordered_json(nullptr)},
          {"inliers", r.num_inliers},
          {"overlap", r.overlap},
          {"information", rows_of(r.information)},
          {"verdict", to_string(r.verdict)},
          {"reason", r.reason},
          {"time_s", time_s},
          {"correspondences", r.num_correspondences},
          {"consistent", r.num_pruned},
          {"weak_axis", r.weak_axis},
          {"weak_direction", rows_of(r.weak_direction)}};
}

/// One standard deviation along each tangent axis of b; an axis that nothing constrains has none.
std::string deviations(const Matrix6& information) {
  const Eigen::LDLT<Matrix6> ldlt(information);
  if (ldlt.info() != Eigen::Success || !(ldlt.rcond() > 1e-12)) return "unbounded along the weak axis";
  const Vector6 sigma = Matrix6(ldlt.solve(Matrix6::Identity())).diagonal().cwiseSqrt();
  const Vector3 degrees = sigma.tail<3>() * 180.0 / std::numbers::pi;
  return format("x {:.4f}, y {:.4f}, z {:.4f} m; roll {:.3f}, pitch {:.3f}, yaw {:.3f} deg", sigma[0],
                sigma[1], sigma[2], degrees[0], degrees[1], degrees[2]);
}

void print_matrix(const char* title, const Eigen::MatrixXd& matrix, const char* number) {
  std::printf("%s\n", title);
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) std::printf(number, matrix(row, column));
    std::printf("\n");
  }
}

void print_text(const Registration& r, double time_s) {
  std::printf("%s: %s\n", std::string(to_string(r.verdict)).c_str(), r.reason.c_str());
  std::printf("correspondences %d, consistent %d, inliers %d, overlap %.2f, weak axis %.3f\n",
              r.num_correspondences, r.num_pruned, r.num_inliers, r.overlap, r.weak_axis);
  if (r.T_a_b) {
    print_matrix(r.verdict == LoopVerdict::accepted ? "T_a_b (p_a = T_a_b * p_b)"
                                                    : "best guess of T_a_b, not to be relied on",
                 r.T_a_b->matrix(), " %12.6f");
  }
  if (!r.information.isZero()) {
    std::printf("standard deviations: %s\n", deviations(r.information).c_str());
    print_matrix("information (right perturbation, translation first)", r.information, " %12.4g");
  }
  std::printf("time %.3f s\n", time_s);
}

Result<> register_files(const RegisterOptions& options, const Common& common) {
  const Result<RunConfig> config = configured(common);
  if (!config) return tl::unexpected(config.error());
  const Result<PointCloud> a = read_cloud(options.cloud_a);
  if (!a) return tl::unexpected(a.error());
  const Result<PointCloud> b = read_cloud(options.cloud_b);
  if (!b) return tl::unexpected(b.error());
  const auto start = std::chrono::steady_clock::now();
  const Registration registration = register_clouds(*a, *b, config->slam.agent().registration_in_use());
  const double time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (common.json) {
    std::printf("%s\n", json_of(registration, time_s).dump().c_str());
  } else {
    print_text(registration, time_s);
  }
  return {};
}

}  // namespace

void add_register(Program& program) {
  const auto options = std::make_shared<RegisterOptions>();
  const Command command = program.add_command(
      "register",
      "Compute the relative pose of two clouds without a guess (fields loops.adaptive.registration.*)",
      [options](const Common& common) { return register_files(*options, common); });
  command.add_option("A", options->cloud_a, "Cloud that the answer refers to (.pcd, .ply, .bin)").required();
  command.add_option("B", options->cloud_b, "Cloud to be placed: p_a = T_a_b * p_b").required();
}

}  // namespace adit::app
