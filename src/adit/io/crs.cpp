// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/crs.hpp"

#include <proj.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/io/las.hpp"

namespace adit {
namespace {

using ProjContext = std::unique_ptr<PJ_CONTEXT, decltype(&proj_context_destroy)>;
using ProjObject = std::unique_ptr<PJ, decltype(&proj_destroy)>;

/// Whether it is written in a language of PROJ; what else PROJ finds may merely be called alike.
bool is_definition(const std::string& crs) {
  return crs.find('[') != std::string::npos || crs.starts_with("+proj") || crs.starts_with("urn:") ||
         (crs.find(':') != std::string::npos && crs.find(' ') == std::string::npos);
}

/// The plane part of a system that may have heights beside it; null where there is none.
ProjObject plane_part(PJ_CONTEXT* context, const PJ* crs) {
  if (proj_get_type(crs) == PJ_TYPE_BOUND_CRS)
    return plane_part(context, ProjObject(proj_get_source_crs(context, crs), &proj_destroy).get());
  if (proj_get_type(crs) == PJ_TYPE_COMPOUND_CRS)
    return plane_part(context, ProjObject(proj_crs_get_sub_crs(context, crs, 0), &proj_destroy).get());
  const bool is_plane =
      proj_get_type(crs) == PJ_TYPE_PROJECTED_CRS || proj_get_type(crs) == PJ_TYPE_ENGINEERING_CRS;
  return {is_plane ? proj_clone(context, crs) : nullptr, &proj_destroy};
}

/// How many metres a unit of its first axis has.
double metres_per_unit(PJ_CONTEXT* context, const PJ* crs) {
  const ProjObject axes(proj_crs_get_coordinate_system(context, crs), &proj_destroy);
  double factor = 0.0;
  if (axes == nullptr || proj_cs_get_axis_info(context, axes.get(), 0, nullptr, nullptr, nullptr, &factor,
                                               nullptr, nullptr, nullptr) == 0)
    return 0.0;
  return factor;
}

/// Of the heights that stand beside a plane; 1 where none do.
double metres_per_height(PJ_CONTEXT* context, const PJ* crs) {
  if (proj_get_type(crs) != PJ_TYPE_COMPOUND_CRS) return 1.0;
  return metres_per_unit(context, ProjObject(proj_crs_get_sub_crs(context, crs, 1), &proj_destroy).get());
}

std::string local_wkt(std::string name) {
  std::erase_if(name, [](char c) { return c == '"' || static_cast<unsigned char>(c) < ' '; });
  return format("LOCAL_CS[\"{}\",UNIT[\"metre\",1]]", name);
}

}  // namespace

Result<std::string> crs_wkt(const std::string& crs) {
  if (crs.empty()) return std::string(kLocalCrs);
  const ProjContext context(proj_context_create(), &proj_context_destroy);
  proj_log_level(context.get(), PJ_LOG_NONE);
  const ProjObject found(proj_create(context.get(), crs.c_str()), &proj_destroy);
  const bool is_crs = found != nullptr && proj_is_crs(found.get()) != 0;
  if (!is_definition(crs)) {
    const char* name = is_crs ? proj_get_name(found.get()) : nullptr;
    if (name == nullptr || name != crs) return local_wkt(crs);
  }
  if (!is_crs)
    return fail(
        format("PROJ knows no coordinate system '{}'; give a code such as EPSG:25833, or the name of a "
               "grid of your own without a colon",
               crs));
  const ProjObject plane = plane_part(context.get(), found.get());
  if (plane == nullptr)
    return fail(
        format("'{}' is no plane system (with eastings and northings); give a projected one, such as "
               "EPSG:25833",
               crs));
  if (std::abs(metres_per_unit(context.get(), plane.get()) - 1.0) > 1e-12 ||
      std::abs(metres_per_height(context.get(), found.get()) - 1.0) > 1e-12)
    return fail(
        format("'{}' is not in metres; maps are: give a system in metres, and control points in it", crs));
  const std::array<const char*, 2> options = {"MULTILINE=NO", nullptr};
  const char* wkt = proj_as_wkt(context.get(), found.get(), PJ_WKT1_GDAL, options.data());
  if (wkt == nullptr) return fail(format("'{}' cannot be written as WKT 1, which LAS files need", crs));
  return std::string(wkt);
}

}  // namespace adit
