// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/html_report.hpp"

#include <algorithm>

#include "adit/core/format.hpp"
#include "adit/report/markup.hpp"
#include "adit/report/text_tables.hpp"

namespace adit {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --paper: #ffffff; --ink: #1f2933; --muted: #5c6b7a; --line: #d9dfe6; --soft: #f4f6f8;
  --good: #0a7a4b; --bad: #c22525; --accent: #0b63a5; }
@media (prefers-color-scheme: dark) { :root { --paper: #14181d; --ink: #e3e8ee; --muted: #9aa7b5; --line: #323b46;
  --soft: #1c2229; --good: #4cc38a; --bad: #ff7b72; --accent: #6cb6ff; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1560px; padding: 2rem clamp(1rem, 4vw, 3rem) 4rem; background: var(--paper); color: var(--ink);
  font: 16px/1.55 "Source Sans 3", "Segoe UI", "Helvetica Neue", Arial, "DejaVu Sans", sans-serif; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.4rem; margin: 3rem 0 1rem; padding-top: 1rem; border-top: 1px solid var(--line); }
p, li { max-width: 80ch; }
a { color: var(--accent); }
nav { margin: 1rem 0; } nav a { margin-right: 1.2em; }
.lead { color: var(--muted); margin-top: 0; }
dl { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: .9rem; margin: 1.5rem 0; }
dl div { background: var(--soft); border-radius: 8px; padding: .7rem .9rem; }
dt { color: var(--muted); font-size: .85rem; } dd { margin: 0; font-weight: 600; overflow-wrap: anywhere; }
figure { margin: 0; }
.tables { display: flex; flex-wrap: wrap; gap: 0 3.5rem; }
figure.table { margin: 0 0 2rem; max-width: 100%; } figure.table figcaption { max-width: 62ch; }
figcaption { color: var(--muted); font-size: .92rem; margin: .45rem 0; max-width: 90ch; } figcaption b { color: var(--ink); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; border-top: 2px solid var(--ink); border-bottom: 2px solid var(--ink); }
th, td { padding: .3rem .9rem; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; padding-left: .3rem; }
thead tr:last-child th { border-bottom: 1px solid var(--ink); }
th { font-weight: 600; } th.group { text-align: center; border-bottom: 1px solid var(--line); }
tbody tr:nth-child(even) { background: var(--soft); }
td.mark { text-align: center; } .good { color: var(--good); font-weight: 700; } .bad { color: var(--bad); font-weight: 700; }
.grid { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 430px), 1fr)); gap: 1.4rem; align-items: start; }
.wide { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 620px), 1fr)); gap: 1.8rem; align-items: start; }
.picture { background: #ffffff; border: 1px solid var(--line); border-radius: 8px; padding: 6px; }
.picture svg { display: block; width: 100%; height: auto; }
pre { background: var(--soft); border-radius: 8px; padding: 1rem; overflow-x: auto; font-size: .85rem; }
summary { cursor: pointer; font-weight: 600; }
@media print { body { max-width: none; padding: 0; } figure { break-inside: avoid; } details > * { display: block; } }
)css";

std::string fact(const std::string& name, const std::string& value) {
  if (value.empty()) return "";
  return format("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(name), escaped(value));
}

std::string facts(const StudyResult& study) {
  double metres = 0.0;
  long long scans = 0;
  for (const RobotResult& robot : study.robots) metres += robot.path_length_m, scans += robot.scans;
  return "<dl>\n" + fact("World", study.world) + fact("LiDAR", study.lidar) +
         fact("Robots", format("{}", study.robots.size())) + fact("Driven", format("{:.0f} m", metres)) +
         fact("Scans", format("{}", scans)) + fact("Seed", format("{}", study.seed)) +
         fact("Time taken", study.wall_s > 0.0 ? format("{:.0f} s", study.wall_s) : "") +
         fact("Peak memory", study.peak_rss_mb > 0.0 ? format("{:.0f} MB", study.peak_rss_mb) : "") +
         fact("adit", study.version) + "</dl>\n";
}

struct Tally {
  std::string keyframes;
  bool pcm = false;
  int runs = 0;
  int successes = 0;
  int failures = 0;
  int refusals = 0;
};

std::vector<Tally> tallies(const StudyResult& study) {
  std::vector<Tally> all;
  for (const PairResult& pair : study.pairs) {
    auto tally = std::find_if(all.begin(), all.end(), [&](const Tally& t) {
      return t.keyframes == pair.keyframes && t.pcm == pair.pcm;
    });
    if (tally == all.end()) tally = all.insert(all.end(), {pair.keyframes, pair.pcm, 0, 0, 0, 0});
    ++tally->runs;
    ++(!pair.merged ? tally->refusals : pair.success() ? tally->successes : tally->failures);
  }
  return all;
}

std::string summary(const StudyResult& study) {
  if (study.pairs.empty()) return "";
  std::string list = "<h2 id=\"summary\">In short</h2>\n<ul>\n";
  for (const Tally& tally : tallies(study)) {
    list += format(
        "<li>Keyframes <b>{}</b>, {} PCM: <b>{} of {}</b> pairs merged within 1 % of their path, {} merged "
        "with a larger error, {} not merged.</li>\n",
        escaped(tally.keyframes), tally.pcm ? "with" : "without", tally.successes, tally.runs, tally.failures,
        tally.refusals);
  }
  if (study.joint) {
    std::size_t largest = 0;
    for (const auto& names : study.joint->components) largest = std::max(largest, names.size());
    list += format(
        "<li>All robots jointly (keyframes <b>{}</b>): the largest shared map holds {} of {} robots; wrong "
        "loops in the solution: {}.</li>\n",
        escaped(study.joint->keyframes), largest, study.robots.size(), study.joint->wrong_loops_in_solution);
  }
  return list + "</ul>\n";
}

std::string picture(const Figure& figure) {
  return format(
      "<figure id=\"{}\">\n<div class=\"picture\" role=\"img\" aria-label=\"{}\">{}</div>\n"
      "<figcaption><b>{}.</b> {}</figcaption>\n</figure>\n",
      escaped(figure.name), escaped(figure.title), figure.svg, escaped(figure.title),
      escaped(figure.caption));
}

std::string pictures(std::span<const Figure> figures, const std::string& section, const char* layout) {
  std::string html;
  for (const Figure& figure : figures) {
    if (figure.section == section) html += picture(figure);
  }
  return html.empty() ? "" : format("<div class=\"{}\">\n{}</div>\n", layout, html);
}

/// The section on merges: what was merged by which evidence, what was not and why, and the figures of the
/// hypotheses.
std::string merges(const StudyResult& study, std::span<const Figure> figures) {
  std::string list;
  for (const PairResult& pair : study.pairs) {
    if (pair.merged) continue;
    list += format("<li>{}, keyframes {}, {} PCM, not merged: {}</li>\n",
                   escaped(pair_section(pair.robots[0].name, pair.robots[1].name)), escaped(pair.keyframes),
                   pair.pcm ? "with" : "without",
                   escaped(pair.refused_reason.empty() ? "no reason was given" : pair.refused_reason));
  }
  if (study.joint) {
    for (const MergePicture& merge : study.joint->merges) {
      if (!merge.merged) continue;
      list += format("<li>Jointly, {} <b class=\"good\">merged</b>: {}</li>\n",
                     escaped(pair_section(merge.robots[0], merge.robots[1])), escaped(merge.verdict));
    }
    for (const std::string& reason : study.joint->refusals)
      list += format("<li>Jointly, not merged: {}</li>\n", escaped(reason));
  }
  if (list.empty()) return "";
  return "<h2 id=\"merges\">What was merged and what was not, and why</h2>\n<p>A refused merge leaves the "
         "maps correct; a wrong one destroys them.</p>\n<ul>\n" +
         list + "</ul>\n" + pictures(figures, kMergeSection, "wide");
}

std::vector<std::string> sections_of(std::span<const Figure> figures) {
  std::vector<std::string> sections;
  for (const Figure& figure : figures) {
    if (figure.section.empty() || figure.section == kMergeSection ||
        std::find(sections.begin(), sections.end(), figure.section) != sections.end())
      continue;
    sections.push_back(figure.section);
  }
  return sections;
}

std::string navigation(const std::vector<std::string>& sections, bool has_tables, bool has_merges) {
  std::string nav = "<nav>";
  if (has_tables) nav += "<a href=\"#tables\">Tables</a>";
  nav += "<a href=\"#figures\">Figures</a>";
  if (has_merges) nav += "<a href=\"#merges\">Merges</a>";
  for (std::size_t i = 0; i < sections.size(); ++i)
    nav += format("<a href=\"#pair-{}\">{}</a>", i, escaped(sections[i]));
  return nav + "<a href=\"#configuration\">Configuration</a></nav>\n";
}

std::string configuration(const StudyResult& study) {
  std::string html = "<h2 id=\"configuration\">Configuration</h2>\n";
  if (!study.command.empty()) html += format("<p>Made by:</p>\n<pre>{}</pre>\n", escaped(study.command));
  if (!study.what_ran.empty()) {
    html += "<p>What ran:</p>\n<ul>\n";
    for (const std::string& line : study.what_ran) html += "<li>" + escaped(line) + "</li>\n";
    html += "</ul>\n";
  }
  if (!study.configuration.empty()) {
    html += "<details><summary>All settings</summary>\n<pre>" + escaped(study.configuration) +
            "</pre>\n</details>\n";
  }
  return html;
}

}  // namespace

std::string html_report(const StudyResult& study, std::span<const Table> tables,
                        std::span<const Figure> figures) {
  const std::vector<std::string> sections = sections_of(figures);
  std::string html = format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>adit{}</title>\n<style>{}</style>\n</head>\n<body>\n",
      study.world.empty() ? "" : ": study of " + escaped(study.world), kStyle);
  const std::string merged = merges(study, figures);
  html += format("<h1>Multi-robot LiDAR SLAM in tunnels</h1>\n<p class=\"lead\">{}</p>\n",
                 study.pairs.empty()
                     ? "Maps of several robots, merged jointly."
                     : "Odometry comparison, map merging of every robot pair, and all robots jointly.");
  html += facts(study) + navigation(sections, !tables.empty(), !merged.empty()) + summary(study);
  if (!tables.empty()) {
    html += "<h2 id=\"tables\">Tables</h2>\n<div class=\"tables\">\n";
    for (const Table& table : tables) html += html_of(table);
    html += "</div>\n";
  }
  html += "<h2 id=\"figures\">Figures</h2>\n" + pictures(figures, "", "wide") + merged;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    html += format("<h2 id=\"pair-{}\">{}</h2>\n{}", i, escaped(sections[i]),
                   pictures(figures, sections[i], "grid"));
  }
  return html + configuration(study) + "</body>\n</html>\n";
}

}  // namespace adit
