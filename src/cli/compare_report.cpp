#include "src/cli/compare_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "src/output/manifest.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;
using Entry = CompareReport::Entry;
using SolutionErrors = CompareReport::SolutionErrors;

constexpr std::array<std::string_view, 4> kClasses = {"facing_away", "open", "blocked", "partial"};

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json json_of(const EntryErrors& e) {
  return {{"pairs", e.pairs}, {"max", e.largest}, {"p999", e.largest_of_999}, {"rms", e.rms}};
}

Json json_of(const std::optional<SolutionErrors>& e) {
  if (!e) return nullptr;
  return {{"error", number(e->all)}, {"error_worst_1_percent", number(e->worst_1_percent)}};
}

Json json_of(const Entry& e) {
  Json errors = {{"facing", json_of(e.errors.facing)}};
  for (std::size_t k = 0; k < kClasses.size(); ++k) errors[std::string(kClasses[k])] = json_of(e.errors.of_class[k]);
  Json worst = Json::array();
  for (std::size_t k = 0; k < e.errors.worst.size(); ++k) {
    const WorstPair& w = e.errors.worst[k];
    worst.push_back({{"i", w.i},
                     {"j", w.j},
                     {"F", w.F},
                     {"truth", w.truth},
                     {"truth_error", w.truth_error},
                     {"standard_error", w.standard_error ? number(*w.standard_error) : Json(nullptr)},
                     {"reason", describe(e.faults[k])}});
  }
  return {{"name", e.name},
          {"form_factor_errors", errors},
          {"solution", json_of(e.B)},
          {"solution_against_reference", json_of(e.B_reference)},
          {"why_no_solution", e.why_no_solution.empty() ? Json(nullptr) : Json(e.why_no_solution)},
          {"mean_standard_error", e.standard_error ? number(*e.standard_error) : Json(nullptr)},
          {"beyond_3_standard_errors",
           e.errors.beyond_3_standard_errors ? number(*e.errors.beyond_3_standard_errors) : Json(nullptr)},
          {"rays", e.rays},
          {"queries", e.queries},
          {"seconds", e.seconds},
          {"cpu_seconds", e.cpu_seconds},
          {"matrix_bytes", e.matrix_bytes},
          {"peak_memory_bytes", e.peak_memory_bytes},
          {"worst", worst}};
}

std::string or_dash(const std::optional<SolutionErrors>& errors, double SolutionErrors::*which) {
  return errors ? fmt::format("{:.2e}", (*errors).*which) : "-";
}

std::string table(const CompareReport& r) {
  std::string text =
      fmt::format("\n  {:<26}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>12}{:>12}{:>10}{:>9}{:>9}{:>9}{:>9}\n", "",
                  "max", "99.9 %", "rms", "of open", "blocked", "partial", "B", "B worst 1%", "std. error", "beyond 3",
                  "Mrays", "Mpoints", "MiB", "CPU s");
  for (const Entry& e : r.entries) {
    const auto largest = [&](PairClass kind) { return e.errors.of_class[static_cast<std::size_t>(kind)].largest; };
    text += fmt::format(
        "  "
        "{:<26}{:>10.2e}{:>10.2e}{:>10.2e}{:>10.2e}{:>10.2e}{:>10.2e}{:>10}{:>12}{:>12}{:>10}{:>9.3g}{:>9.3g}{:>9.3g}{:"
        ">9.3g}"
        "\n",
        e.name, e.errors.facing.largest, e.errors.facing.largest_of_999, e.errors.facing.rms, largest(PairClass::open),
        largest(PairClass::blocked), largest(PairClass::partial), or_dash(e.B, &SolutionErrors::all),
        or_dash(e.B, &SolutionErrors::worst_1_percent),
        e.standard_error ? fmt::format("{:.2e}", *e.standard_error) : "-",
        e.errors.beyond_3_standard_errors ? fmt::format("{:.2g} %", 100 * *e.errors.beyond_3_standard_errors) : "-",
        1e-6 * static_cast<double>(e.rays), 1e-6 * static_cast<double>(e.queries),
        0x1p-20 * static_cast<double>(e.matrix_bytes), e.cpu_seconds);
  }
  return text;
}

std::string against_reference(const CompareReport& r) {
  std::string text = fmt::format("\n  {:<26}{:>10}{:>12}   of B against {}\n", "", "all", "worst 1 %", r.reference);
  const auto line = [&](std::string_view name, const std::optional<SolutionErrors>& errors) {
    text += fmt::format("  {:<26}{:>10}{:>12}\n", name, or_dash(errors, &SolutionErrors::all),
                        or_dash(errors, &SolutionErrors::worst_1_percent));
  };
  line("truth", r.truth_B_reference);
  for (const Entry& e : r.entries) line(e.name, e.B_reference);
  return text;
}

std::string worst_pairs(const Entry& e) {
  if (e.errors.worst.empty()) return fmt::format("\n{}: every form factor is right\n", e.name);
  std::string text = fmt::format("\n{}: worst pairs\n  {:>8}{:>8}{:>13}{:>13}{:>11}{:>12}  reason\n", e.name, "from",
                                 "to", "F", "truth", "error", "std. error");
  for (std::size_t k = 0; k < e.errors.worst.size(); ++k) {
    const WorstPair& w = e.errors.worst[k];
    text += fmt::format("  {:>8}{:>8}{:>13.6g}{:>13.6g}{:>11.2e}{:>12}  {}\n", w.i, w.j, w.F, w.truth, w.F - w.truth,
                        w.standard_error ? fmt::format("{:.2e}", *w.standard_error) : "-", describe(e.faults[k]));
  }
  return text;
}

}  // namespace

std::string in_words(const CompareReport& r) {
  std::string text = fmt::format("{}: {} patches; ordered pairs", r.scene, r.patches);
  for (std::size_t k = 0; k < kClasses.size(); ++k) {
    text += fmt::format("{} {} {}", k == 0 ? "" : ",", r.pairs[k], k == 0 ? "facing away" : kClasses[k]);
  }
  text += fmt::format(
      "\n  truth: exact visibility to {:g}, errors at most {:.2g}{}; {:.3g} Mpoints, {:.3g} s of processor time{}\n",
      r.truth_tolerance, r.truth_largest_error,
      r.truth_unreached > 0 ? fmt::format(" ({} pairs did not reach it)", r.truth_unreached) : "",
      1e-6 * static_cast<double>(r.truth_queries), r.truth_cpu_seconds,
      r.truth_resumed_rows > 0 ? fmt::format(", without {} rows of an earlier run", r.truth_resumed_rows) : "");
  text += "  errors of F are absolute, of all pairs that do not face away; those of B relative (George, eq. 7)\n";
  text += table(r);
  if (!r.reference.empty()) text += against_reference(r);
  for (const Entry& e : r.entries) {
    if (!e.why_no_solution.empty()) text += fmt::format("\n{}: no solution: {}\n", e.name, e.why_no_solution);
  }
  for (const Entry& e : r.entries) text += worst_pairs(e);
  return text;
}

std::string to_json(const CompareReport& r) {
  Json pairs = Json::object(), contenders = Json::array();
  for (std::size_t k = 0; k < kClasses.size(); ++k) pairs[std::string(kClasses[k])] = r.pairs[k];
  for (const Entry& e : r.entries) contenders.push_back(json_of(e));
  const Manifest build = build_manifest();
  const Json json = {{"scene", r.scene},
                     {"scene_hash", r.scene_hash},
                     {"patches", r.patches},
                     {"patch_size", r.patch_size},
                     {"pairs", pairs},
                     {"truth",
                      {{"tolerance", r.truth_tolerance},
                       {"largest_error", number(r.truth_largest_error)},
                       {"unreached", r.truth_unreached},
                       {"resumed_rows", r.truth_resumed_rows},
                       {"queries", r.truth_queries},
                       {"seconds", r.truth_seconds},
                       {"cpu_seconds", r.truth_cpu_seconds},
                       {"solution_against_reference", json_of(r.truth_B_reference)}}},
                     {"reference", r.reference.empty() ? Json(nullptr) : Json(r.reference)},
                     {"contenders", contenders},
                     {"warnings", r.warnings},
                     {"manifest",
                      {{"version", build.version},
                       {"commit", build.commit},
                       {"compiler", build.compiler},
                       {"libraries", build.libraries},
                       {"threads", r.threads},
                       {"options", r.options}}}};
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace exitance
