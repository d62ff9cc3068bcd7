// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "command_line.hpp"

int main(int argc, char** argv) {
  adit::app::Program program;
  add_study(program);
  add_merge_study(program);
  add_merge_curves(program);
  add_merge_calibration(program);
  add_loop_study(program);
  add_uncertainty_study(program);
  add_slam(program);
  add_merge(program);
  add_localize(program);
  add_georeference(program);
  add_world(program);
  add_routes(program);
  add_simulate(program);
  add_odometry(program);
  add_register(program);
  add_solve(program);
  add_evaluate(program);
  add_explain(program);
  add_convert(program);
  add_info(program);
  add_doctor(program);
  add_config(program);
  add_describe(program);
  return program.run(argc, argv);
}
