// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "harness/page.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "adit/core/format.hpp"
#include "adit/report/palette.hpp"
#include "adit/report/svg.hpp"

namespace adit::bench {
namespace {

using nlohmann::json;

json json_of(const Spread& s) { return {s.min, s.median, s.max}; }
Spread spread_from(const json& j) { return {j.at(0), j.at(1), j.at(2)}; }

json json_of(const Measured& m) { return {{"version", m.version}, {"machine", m.machine}, {"date", m.date}}; }
Measured measured_from(const json& j) { return {j.at("version"), j.at("machine"), j.at("date")}; }

json json_of(const About& about) {
  return {{"version", about.version},
          {"build", about.build},
          {"timed", about.timed},
          {"threads", about.num_threads},
          {"environment", about.environment}};
}
About about_from(const json& j) {
  return {j.at("version"), j.at("build"), j.at("timed"), j.at("threads"), j.at("environment")};
}

json json_of(const SideResult& side) {
  if (!side.skipped.empty()) return {{"side", side.side}, {"skipped", side.skipped}};
  return {{"side", side.side},
          {"about", json_of(side.about)},
          {"seconds", json_of(side.seconds)},
          {"ratio", json_of(side.ratio)},
          {"peak_mb", side.peak_mb},
          {"figures", side.figures}};
}
SideResult side_from(const json& j) {
  SideResult side;
  side.side = j.at("side");
  side.skipped = j.value("skipped", "");
  if (!side.skipped.empty()) return side;
  side.about = about_from(j.at("about"));
  side.seconds = spread_from(j.at("seconds"));
  side.ratio = spread_from(j.at("ratio"));
  side.peak_mb = j.at("peak_mb");
  side.figures = j.at("figures").get<Figures>();
  return side;
}

std::string digits(double value) {
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  if (size >= 1e6) return format("{:.8g}", value);
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 6);
  return format("{:.{}f}", value, decimals);
}

std::string time_text(double seconds) {
  if (seconds >= 1.0) return digits(seconds) + " s";
  if (seconds >= 1e-3) return digits(seconds * 1e3) + " ms";
  return digits(seconds * 1e6) + " us";
}

std::string ratio_text(const Spread& ratio) {
  return format("{:.2f} ({:.2f}-{:.2f})", ratio.median, ratio.min, ratio.max);
}

const SideResult* measured(const CaseResult* result, const std::string& side) {
  const SideResult* found = result == nullptr ? nullptr : result->side(side);
  return found != nullptr && found->skipped.empty() ? found : nullptr;
}

const CaseResult* find_case(const Results& results, const std::string& name) {
  const auto found = std::ranges::find(results.cases, name, [](const CaseResult& c) { return c.info.name; });
  return found == results.cases.end() ? nullptr : &*found;
}

/// Texts of one row, the same on the terminal and on the page.
struct Row {
  std::string name, ours, peer, ratio, aim, memory, last;
};

Row row_of(const CaseResult& result, const Results& recorded) {
  Row row;
  row.name = result.info.name;
  if (result.info.aim > 0.0) row.aim = format("{:g}", result.info.aim);
  const SideResult* ours = measured(&result, "adit");
  const SideResult* peer = measured(&result, result.info.peer);
  const CaseResult* before = find_case(recorded, result.info.name);
  if (const SideResult* last = measured(before, "adit")) {
    row.last = time_text(last->seconds.median);
    if (const SideResult* its_peer = measured(before, result.info.peer))
      row.last += format(" ({:.2f})", its_peer->ratio.median);
  }
  if (ours == nullptr) {
    row.ours = "SKIPPED: " + (result.sides.empty() ? "no side" : result.sides.front().skipped);
    return row;
  }
  row.ours = time_text(ours->seconds.median) + (result.info.unit.empty() ? "" : " / " + result.info.unit);
  row.memory = format("{:.0f}", ours->peak_mb);
  if (peer != nullptr) {
    row.peer = format("{} {}", result.info.peer, time_text(peer->seconds.median));
    row.ratio = ratio_text(peer->ratio);
    row.memory += format(" / {:.0f}", peer->peak_mb);
    if (result.info.aim > 0.0) row.aim += peer->ratio.median >= result.info.aim ? " met" : " NOT met";
  } else if (const SideResult* absent = result.side(result.info.peer)) {
    row.peer = result.info.peer + " SKIPPED: " + absent->skipped;
  }
  return row;
}

bool is_dirty(const Measured& m) { return m.version.ends_with("-dirty"); }

}  // namespace

json json_of(const Results& results) {
  json cases = json::array();
  for (const CaseResult& c : results.cases) {
    json sides = json::array();
    for (const SideResult& side : c.sides) sides.push_back(json_of(side));
    cases.push_back({{"measured", json_of(c.measured)},
                     {"name", c.info.name},
                     {"work", c.info.work},
                     {"scene", c.info.scene},
                     {"threads", c.info.num_threads},
                     {"peer", c.info.peer},
                     {"aim", c.info.aim},
                     {"note", c.info.note},
                     {"unit", c.info.unit},
                     {"sides", sides}});
  }
  json growths = json::array();
  for (const GrowthResult& g : results.growths) {
    json points = json::array();
    for (const GrowthPoint& point : g.points)
      points.push_back({{"size", point.size}, {"result", json_of(point.result)}});
    growths.push_back({{"measured", json_of(g.measured)},
                       {"name", g.name},
                       {"title", g.title},
                       {"size_label", g.size_label},
                       {"points", points}});
  }
  return {{"cases", cases}, {"growths", growths}};
}

Results results_from(const json& document) {
  Results out;
  for (const json& c : document.at("cases")) {
    CaseResult& result = out.cases.emplace_back();
    result.measured = measured_from(c.at("measured"));
    result.info = {.name = c.at("name"),
                   .work = c.at("work"),
                   .scene = c.at("scene"),
                   .num_threads = c.at("threads"),
                   .peer = c.at("peer"),
                   .aim = c.at("aim"),
                   .note = c.at("note"),
                   .per_run = 1.0,
                   .unit = c.at("unit")};
    for (const json& side : c.at("sides")) result.sides.push_back(side_from(side));
  }
  for (const json& g : document.at("growths")) {
    GrowthResult& growth = out.growths.emplace_back();
    growth.measured = measured_from(g.at("measured"));
    growth.name = g.at("name");
    growth.title = g.at("title");
    growth.size_label = g.at("size_label");
    for (const json& point : g.at("points"))
      growth.points.push_back({point.at("size"), side_from(point.at("result"))});
  }
  return out;
}

Results merged(Results now, const Results& before) {
  for (const CaseResult& c : before.cases) {
    if (find_case(now, c.info.name) == nullptr) now.cases.push_back(c);
  }
  for (const GrowthResult& g : before.growths) {
    if (std::ranges::find(now.growths, g.name, &GrowthResult::name) == now.growths.end())
      now.growths.push_back(g);
  }
  std::ranges::sort(now.cases, {}, [](const CaseResult& c) { return c.info.name; });
  std::ranges::sort(now.growths, {}, &GrowthResult::name);
  return now;
}

Results recordable(Results now, const Results& before) {
  const auto known = [](const auto& row) {
    if constexpr (requires { row.info; })
      return registry().cases.contains(row.info.name);
    else
      return registry().growths.contains(row.name);
  };
  const auto keep = [&](auto& rows, const auto& kept) {
    std::erase_if(rows, [&](const auto& row) { return !kept(row); });
  };
  const auto refuse_dirty = [](const auto& rows) {
    for (const auto& row : rows) {
      if (is_dirty(row.measured))
        throw std::runtime_error("measured with uncommitted changes (" + row.measured.version +
                                 "): commit them and run again; only a committed version is recorded");
    }
  };
  keep(now.cases, known);
  keep(now.growths, known);
  refuse_dirty(now.cases);
  refuse_dirty(now.growths);
  const auto may_stay = [&](const auto& row) { return known(row) && !is_dirty(row.measured); };
  Results old = before;
  keep(old.cases, may_stay);
  keep(old.growths, may_stay);
  return merged(std::move(now), old);
}

std::string table_head() {
  return format("{:<36} {:>18}  {:<28} {:<20} {:<12} {:<13} {}\n", "case", "adit", "peer", "ratio (min-max)",
                "aim", "MB ours/peer", "last recorded (ratio)");
}

std::string table_row(const CaseResult& result, const Results& recorded) {
  const Row row = row_of(result, recorded);
  return format("{:<36} {:>18}  {:<28} {:<20} {:<12} {:<13} {}\n", row.name, row.ours, row.peer, row.ratio,
                row.aim, row.memory, row.last);
}

std::string figure_name(const GrowthResult& growth) {
  std::string name = "growth_" + growth.name + ".svg";
  std::ranges::replace(name, '/', '_');
  return name;
}

std::string plot_growth(const GrowthResult& growth) {
  constexpr double kWidth = 640.0;
  constexpr double kHeight = 360.0;
  const Point2 low(76.0, kHeight - 56.0);
  const Point2 high(kWidth - 24.0, 48.0);
  std::vector<std::pair<double, double>> points;
  for (const GrowthPoint& p : growth.points) {
    if (p.result.skipped.empty()) points.emplace_back(p.size, p.result.seconds.median * 1e3);
  }
  SvgCanvas canvas(kWidth, kHeight);
  canvas.text({20.0, 28.0}, growth.title, {.weight = 600});
  if (points.size() < 2) return canvas.document();
  const auto [x0, x1] = std::pair(points.front().first, points.back().first);
  const auto by_time = [](const auto& a, const auto& b) { return a.second < b.second; };
  const double y0 = std::ranges::min_element(points, by_time)->second * 0.7;
  const double y1 = std::ranges::max_element(points, by_time)->second * 1.4;
  const auto at = [&](double x, double y) {
    return Point2(low.x() + (high.x() - low.x()) * std::log(x / x0) / std::log(x1 / x0),
                  low.y() + (high.y() - low.y()) * std::log(y / y0) / std::log(y1 / y0));
  };
  for (const double tick : log_ticks(y0, y1)) {
    canvas.line({low.x(), at(x0, tick).y()}, {high.x(), at(x0, tick).y()}, {kGrid, 1.0});
    canvas.text({low.x() - 8.0, at(x0, tick).y() + 4.0}, tick_text(tick),
                {.color = kMutedInk, .size = 12.0, .anchor = Anchor::end});
  }
  std::vector<Point2> line;
  for (const auto& [x, y] : points) {
    line.push_back(at(x, y));
    canvas.text({at(x, y).x(), low.y() + 18.0}, tick_text(x),
                {.color = kMutedInk, .size = 12.0, .anchor = Anchor::middle});
  }
  // The line of growth in proportion to the size.
  const auto [first_x, first_y] = points.front();
  const double end_x = std::min(x1, x0 * y1 / first_y);
  canvas.line(at(first_x, first_y), at(end_x, first_y * end_x / first_x), {kMutedInk, 1.0, 0.6});
  canvas.polyline(line, {method_color(0), 2.5});
  for (const Point2& p : line) canvas.circle(p, 4.0, method_color(0));
  canvas.text({0.5 * (low.x() + high.x()), kHeight - 12.0}, growth.size_label + " (thin line: in proportion)",
              {.color = kMutedInk, .anchor = Anchor::middle});
  canvas.text({20.0, 0.5 * (low.y() + high.y())}, "ms",
              {.color = kMutedInk, .anchor = Anchor::middle, .turn_deg = -90.0});
  return canvas.document();
}

}  // namespace adit::bench
