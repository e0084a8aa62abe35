#include "src/cli/formfactor_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string_view>

#include "src/output/manifest.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> kClasses = {"facing_away", "open", "blocked", "partial"};

std::string dumped(const Json& json) {
  // Names in files need not be UTF-8.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string row_in_words(const FormFactorReport& r, std::uint32_t row) {
  return fmt::format("row {} ({})", row, r.row_names[row]);
}

std::string compared(double amount, double allowed) {
  return fmt::format("{:.3g}, errors allow {:.3g}", amount, allowed);
}

std::string why_no_closure(const FormFactorReport& r) {
  if (!r.closed) return "the scene is open";
  if (!r.only_fronts) return "contacts, back sides or obstructions are in view";
  return "no patch sees another";
}

/// What holds, or fails, of so many; and what comes nearest to failing, or is worst.
std::string verdict(bool holds, const std::string& of_what, double amount, double allowed, const std::string& where) {
  return fmt::format("{} {}; against its errors worst: {} {}", holds ? "holds for" : "fails, of", of_what,
                     compared(amount, allowed), where);
}

std::optional<MatrixDefect> closure(const FormFactorReport& r) {
  return r.only_fronts ? r.matrix.closure : std::nullopt;
}

Json by_class(const auto& values) {
  Json json = Json::object();
  for (std::size_t k = 0; k < kClasses.size(); ++k) json[std::string(kClasses[k])] = values[k];
  return json;
}

Json of_row(const FormFactorReport& r, const std::optional<MatrixDefect>& defect) {
  if (!defect) return nullptr;
  return {{"row", defect->row},
          {"name", r.row_names[defect->row]},
          {"defect", defect->amount},
          {"allowed", defect->allowed},
          {"holds", defect->holds()}};
}

Json of_pair(const std::optional<PairDefect>& defect) {
  if (!defect) return nullptr;
  return {{"patches", {defect->i, defect->j}},
          {"defect", defect->amount},
          {"allowed", defect->allowed},
          {"holds", defect->holds()}};
}

Json manifest(const FormFactorReport& r) {
  const Manifest build = build_manifest();
  return {{"version", build.version},
          {"commit", build.commit},
          {"compiler", build.compiler},
          {"libraries", build.libraries},
          {"scene_hash", r.scene_hash}};
}

double largest_amount(const std::vector<PairDefect>& defects) {
  double largest = 0;
  for (const PairDefect& defect : defects) largest = std::max(largest, defect.amount);
  return largest;
}

}  // namespace

std::optional<PairDefect> worst_of(const std::vector<PairDefect>& defects) {
  const auto worst = std::ranges::max_element(defects, {}, &PairDefect::share);
  return worst == defects.end() ? std::nullopt : std::optional(*worst);
}

std::vector<std::string> failed_checks(const FormFactorReport& r) {
  std::vector<std::string> failed;
  if (const auto& worst = r.matrix.excess; worst && !worst->holds()) {
    failed.push_back(fmt::format("{} sums to more than 1 by {}", row_in_words(r, worst->row),
                                 compared(worst->amount, worst->allowed)));
  }
  if (const auto worst = closure(r);
      worst && !worst->holds() && (failed.empty() || worst->row != r.matrix.excess->row)) {
    failed.push_back(fmt::format("the scene is closed, but {} misses 1 by {} (unless surfaces pierce each other there)",
                                 row_in_words(r, worst->row), compared(worst->amount, worst->allowed)));
  }
  if (const auto& worst = r.matrix.entry; worst && !worst->holds()) {
    failed.push_back(fmt::format("F from row {} to {} exceeds min(1, A_j / A_i) by {}", worst->row, worst->column,
                                 compared(worst->amount, worst->allowed)));
  }
  if (const auto worst = worst_of(r.sample.reciprocity); worst && !worst->holds()) {
    failed.push_back(fmt::format("patches {} and {}, integrated over either, differ by {}", worst->i, worst->j,
                                 compared(worst->amount, worst->allowed)));
  }
  if (const auto worst = worst_of(r.sample.beyond_unobstructed); worst && !worst->holds()) {
    failed.push_back(fmt::format("patches {} and {} exchange more than with nothing in between, by {}", worst->i,
                                 worst->j, compared(worst->amount, worst->allowed)));
  }
  return failed;
}

std::string in_words(const FormFactorReport& r) {
  std::string text = fmt::format("{}\n", r.scene);
  const auto line = [&](std::string_view name, const std::string& value) {
    text += fmt::format("  {:<22}{}\n", name, value);
  };
  line("surfaces, patches", fmt::format("{}, {}", r.surfaces, r.patches));
  line("matrix", fmt::format("{} rows, {} entries, errors up to {:.3g}", r.rows, r.entries, r.matrix.largest_error));
  const double all = static_cast<double>(
      std::max<std::uint64_t>(1, std::accumulate(r.pairs.begin(), r.pairs.end(), std::uint64_t{0})));
  line("pairs", fmt::format("{:.0f} unordered, each patch with itself included", all));
  for (std::size_t k = 0; k < kClasses.size(); ++k) {
    std::string name = k == 0 ? "pairs facing away" : fmt::format("pairs {}", kClasses[k]);
    line(name, fmt::format("{} ({:.1f} %), {:.2f} s", r.pairs[k], 100 * static_cast<double>(r.pairs[k]) / all,
                           r.class_seconds[k]));
  }
  line("points looked from", fmt::format("{}", r.points));
  line("pairs not reached",
       fmt::format("{} of tolerance {:.3g}, relative {:.3g}", r.unreached, r.tolerance, r.relative));
  if (r.resumed_rows > 0) line("resumed", fmt::format("{} patches, without their times and points", r.resumed_rows));
  line("largest row sum", fmt::format("{:.15g}, {} rows are empty", r.matrix.largest_sum, r.matrix.empty_rows));
  if (const auto worst = closure(r)) {
    line("closure defect", fmt::format("{:.3g} at {}; against its errors worst: {} at {}", r.matrix.largest_defect,
                                       row_in_words(r, r.matrix.largest_defect_row),
                                       compared(worst->amount, worst->allowed), row_in_words(r, worst->row)));
  } else {
    line("closure defect", "none, " + why_no_closure(r));
  }
  if (const auto worst = worst_of(r.sample.reciprocity)) {
    line("reciprocity defect",
         fmt::format("{:.3g} in {} pairs integrated again; against its errors worst: {} at patches {}, {}",
                     largest_amount(r.sample.reciprocity), r.sample.reciprocity.size(),
                     compared(worst->amount, worst->allowed), worst->i, worst->j));
  } else {
    line("reciprocity defect", "not measured, no pair is partial");
  }
  if (const auto& worst = r.matrix.entry) {
    line("F <= min(1, A_j/A_i)",
         verdict(worst->holds(), fmt::format("{} ordered pairs of rows", r.entries), worst->amount, worst->allowed,
                 fmt::format("from row {} to {}", worst->row, worst->column)));
  } else {
    line("F <= min(1, A_j/A_i)", "no entry to check");
  }
  if (const auto worst = worst_of(r.sample.beyond_unobstructed)) {
    line(
        "blocked <= unblocked",
        verdict(worst->holds(), fmt::format("{} unordered pairs integrated again", r.sample.beyond_unobstructed.size()),
                worst->amount, worst->allowed, fmt::format("at patches {}, {}", worst->i, worst->j)));
  } else {
    line("blocked <= unblocked", "not measured, no pair is partial");
  }
  if (r.rows_closed) {
    line("rows closed", fmt::format("entries changed by up to {:.3g} (row {}, column {}), factors up to {:.15g}, in {}",
                                    r.rows_closed->largest_change, r.rows_closed->row, r.rows_closed->column,
                                    r.rows_closed->largest_factor, r.closed_file));
  }
  line("time", fmt::format("{:.2f} s: form factors {:.2f}, checks {:.2f}, output {:.2f}; {} threads", r.seconds.total,
                           r.seconds.form_factors, r.seconds.checks, r.seconds.output, r.threads));
  line("memory", fmt::format("{:.0f} MiB at most", static_cast<double>(r.peak_memory_bytes) * 0x1p-20));
  return text;
}

std::string to_json(const FormFactorReport& r) {
  const auto closing = closure(r);
  Json whole = manifest(r);
  whole["threads"] = r.threads;
  whole["seed"] = r.seed;
  whole["options"] = r.options;
  Json rows_closed = nullptr;
  if (r.rows_closed) {
    rows_closed = {{"largest_change", r.rows_closed->largest_change},
                   {"row", r.rows_closed->row},
                   {"column", r.rows_closed->column},
                   {"largest_factor", r.rows_closed->largest_factor},
                   {"file", r.closed_file}};
  }
  const Json json = {{"scene", r.scene},
                     {"surfaces", r.surfaces},
                     {"patches", r.patches},
                     {"rows", r.rows},
                     {"entries", r.entries},
                     {"patch_size", r.patch_size},
                     {"tolerance", r.tolerance},
                     {"relative", r.relative},
                     {"receivers", "area"},
                     {"visibility", "exact"},
                     {"file", r.file},
                     {"pairs", by_class(r.pairs)},
                     {"pair_seconds", by_class(r.class_seconds)},
                     {"points", r.points},
                     {"unreached", r.unreached},
                     {"resumed_rows", r.resumed_rows},
                     {"largest_error", r.matrix.largest_error},
                     {"largest_row_sum", r.matrix.largest_sum},
                     {"empty_rows", r.matrix.empty_rows},
                     {"closed", r.closed},
                     {"closure_max_defect", closing ? Json(r.matrix.largest_defect) : Json(nullptr)},
                     {"closure_worst", closing ? of_row(r, closing) : Json{{"none_because", why_no_closure(r)}}},
                     {"row_sum_worst", of_row(r, r.matrix.excess)},
                     {"entry_worst", r.matrix.entry ? Json{{"row", r.matrix.entry->row},
                                                           {"column", r.matrix.entry->column},
                                                           {"defect", r.matrix.entry->amount},
                                                           {"allowed", r.matrix.entry->allowed},
                                                           {"holds", r.matrix.entry->holds()}}
                                                    : Json(nullptr)},
                     {"reciprocity_max_defect",
                      r.sample.reciprocity.empty() ? Json(nullptr) : Json(largest_amount(r.sample.reciprocity))},
                     {"reciprocity_pairs", r.sample.reciprocity.size()},
                     {"reciprocity_worst", of_pair(worst_of(r.sample.reciprocity))},
                     {"beyond_unobstructed_worst", of_pair(worst_of(r.sample.beyond_unobstructed))},
                     {"rows_closed", rows_closed},
                     {"failed", failed_checks(r)},
                     {"seconds",
                      {{"load", r.seconds.load},
                       {"form_factors", r.seconds.form_factors},
                       {"checks", r.seconds.checks},
                       {"output", r.seconds.output},
                       {"total", r.seconds.total}}},
                     {"estimated_memory_bytes", r.estimated_bytes},
                     {"available_memory_bytes", r.available_bytes},
                     {"peak_memory_bytes", r.peak_memory_bytes},
                     {"warnings", r.warnings},
                     {"manifest", whole}};
  return dumped(json);
}

std::string matrix_manifest(const FormFactorReport& r) {
  Json json = manifest(r);
  json["scene"] = r.scene;
  json["receivers"] = "area";
  json["visibility"] = "exact";
  json["patch_size"] = r.patch_size;
  json["tolerance"] = r.tolerance;
  json["relative"] = r.relative;
  if (r.rows_closed) json["rows_closed"] = {{"largest_change", r.rows_closed->largest_change}};
  return dumped(json);
}

}  // namespace exitance
