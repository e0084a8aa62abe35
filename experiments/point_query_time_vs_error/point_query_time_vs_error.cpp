// At which error do rays cost as much as the exact answer? Points that see a polygon in part, in rooms of triangles.

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/plot_note.h"
#include "experiments/power_law.h"
#include "src/output/plot.h"
#include "src/visibility/measured_room.h"

namespace exitance {
namespace {

constexpr std::uint32_t kMostRays = 65536;

struct Query {
  Receiver receiver;
  Source source;
  double F = 0, F_error = 0, F_unoccluded = 0;
};

/// A room of about so many triangles and questions in it whose answers two ways agree on.
struct Questions {
  Questions(std::int64_t triangles, std::size_t count) : room(cut_into_triangles(furnished_room(triangles / 2))) {
    std::mt19937_64 random(2);
    Viewpoint view(room.soup);
    const ShadowRays many(room.soup, {.rays = 1024, .replicates = 16});
    const ShadowRays farther(room.soup, {.rays = 1024, .replicates = 16, .offset = 2 * RayOptions{}.offset});
    while (queries.size() < count) {
      const Element& element = random_element(room, random);
      Query q{receiver_at(element), {static_cast<std::uint32_t>(below(random, room.facets())), {}}};
      view.look_from(q.receiver);
      const PointFormFactor exact = view.form_factor(q.source, kPointTolerance);
      if (exact.side != Side::front || exact.visibility != Visibility::partial) continue;
      const SampledFormFactor near = many.form_factor(q.receiver, q.source, queries.size()),
                              far = farther.form_factor(q.receiver, q.source, queries.size());
      const double share = exact.F / near.F_unoccluded;
      if (!(0.01 < share && share < 0.99)) continue;
      // Rays know F to six standard errors, ten rays' share, and the bias of their offset, which twice the offset
      // changes by as much as the bias itself.
      const double allowed = 6 * (near.standard_error + far.standard_error) + 3 * std::fabs(near.F - far.F) +
                             10.0 / (16 * 1024) * near.F_unoccluded;
      if (!(std::fabs(exact.F - near.F) <= allowed))
        throw std::runtime_error(fmt::format("rays find {} ± {}, exact visibility {}", near.F, allowed, exact.F));
      q.F = exact.F;
      q.F_error = exact.error;
      q.F_unoccluded = near.F_unoccluded;
      queries.push_back(q);
    }
    for (std::size_t k = 0; k < 2; ++k)
      require_closure(look_around(room, view, queries[k].receiver), queries[k].receiver);
  }

  MeasuredRoom room;
  std::vector<Query> queries;
};

/// Errors are shares of what would be seen without occluders. claimed: rms of the errors that the answers state: proven
/// bounds of exact ones, standard errors of rays.
struct Measured {
  double rms = 0, largest = 0, claimed = 0, seconds = 0;
};

Measured exact(const Questions& questions) {
  Viewpoint view(questions.room.soup);
  std::vector<double> seconds_of_rounds;
  for (int round = 0; round < 5; ++round) {
    seconds_of_rounds.push_back(seconds([&] {
      for (const Query& q : questions.queries) {
        view.look_from(q.receiver);
        if (view.form_factor(q.source, kPointTolerance).F != q.F) throw std::runtime_error("another answer");
      }
    }));
  }
  Measured m;
  const double n = static_cast<double>(questions.queries.size());
  for (const Query& q : questions.queries) {
    const double bound = q.F_error / q.F_unoccluded;
    m.claimed += bound * bound / n;
    m.largest = std::max(m.largest, bound);
  }
  m.rms = m.claimed = std::sqrt(m.claimed);
  m.seconds = median(seconds_of_rounds) / n;
  return m;
}

Measured by_rays(const Questions& questions, const RayOptions& options) {
  const ShadowRays rays(questions.room.soup, options);
  std::vector<SampledFormFactor> found(questions.queries.size());
  std::vector<double> seconds_of_rounds;
  for (int round = 0; round < (options.rays < 1024 ? 3 : 1); ++round) {
    seconds_of_rounds.push_back(seconds([&] {
      for (std::size_t k = 0; k < found.size(); ++k)
        found[k] = rays.form_factor(questions.queries[k].receiver, questions.queries[k].source, k);
    }));
  }
  Measured m;
  const double n = static_cast<double>(found.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Query& q = questions.queries[k];
    const double error = std::fabs(found[k].F - q.F) / q.F_unoccluded,
                 claimed = found[k].standard_error / q.F_unoccluded;
    m.rms += error * error / n;
    m.claimed += claimed * claimed / n;
    m.largest = std::max(m.largest, error);
  }
  m.rms = std::sqrt(m.rms);
  m.claimed = std::sqrt(m.claimed);
  m.seconds = median(seconds_of_rounds) / n;
  return m;
}

struct Way {
  std::string name;
  RayOptions options;
};

std::vector<Way> ways() {
  return {{"random", {.sampler = Sampler::random}},
          {"stratified", {.sampler = Sampler::stratified}},
          {"sobol", {.sampler = Sampler::sobol}},
          {"owen", {.sampler = Sampler::owen}},
          {"sobol offset 2^-22", {.sampler = Sampler::sobol, .offset = 0x1p-22}},
          {"sobol fraction", {.sampler = Sampler::sobol, .estimator = Estimator::fraction}}};
}

std::string ratio(std::optional<double> seconds_of_rays, double exact_seconds) {
  return seconds_of_rays ? fmt::format("{:.3g}", *seconds_of_rays / exact_seconds) : "never";
}

/// Adds a room to the tables; draws it where it is the one to draw.
void answer(std::int64_t triangles, std::size_t count, std::uint32_t most_rays, CsvTable& table, CsvTable& prices,
            Plot* plot) {
  const Questions questions(triangles, count);
  const std::string room = fmt::format("{}", triangles);
  const auto row = [&](const std::string& name, std::uint32_t rays, const Measured& m) {
    table.rows.push_back({room, name, fmt::format("{}", rays), fmt::format("{}", questions.queries.size()),
                          digits(m.rms), digits(m.largest), digits(m.claimed), digits(m.seconds)});
  };
  const Measured before = exact(questions);
  row("exact", 0, before);
  std::vector<std::pair<std::string, Curve>> curves;
  for (const Way& way : ways()) {
    Curve of_rays, of_time;
    RayOptions options = way.options;
    for (options.rays = 4; options.rays <= most_rays; options.rays *= 4) {
      const Measured m = by_rays(questions, options);
      row(way.name, options.rays, m);
      if (options.rays >= 16) of_rays.emplace_back(options.rays, m.rms);
      of_time.emplace_back(m.seconds, m.rms);
    }
    curves.emplace_back(fmt::format("{} (N^{:.2f})", way.name, slope(of_rays)), of_time);
    const std::optional<double> at_exact_price = y_at(of_time, before.seconds);
    prices.rows.push_back({room, way.name, fmt::format("{:.3f}", slope(of_rays)),
                           digits(before.seconds / (of_time.back().first / most_rays)),
                           at_exact_price ? digits(*at_exact_price) : "none",
                           ratio(x_at(of_time, 1e-2), before.seconds), ratio(x_at(of_time, 1e-3), before.seconds),
                           ratio(x_at(of_time, 1e-4), before.seconds)});
    fmt::print(stderr, "{} triangles, {}\n", triangles, curves.back().first);
  }
  if (plot == nullptr) return;
  for (auto& [name, curve] : curves) plot->series.push_back({name, std::move(curve)});
  plot->series.push_back({"exact (proven bound)", {{before.seconds, before.rms}, {before.seconds, before.largest}}});
}

int run(int argc, char** argv) {
  CLI::App app{"Error against time of form factors from a point to a polygon seen in part"};
  std::vector<std::int64_t> rooms{500, 25'000, 1'000'000};
  std::size_t count = 100;
  app.add_option("--triangles", rooms, "Of each room, about")->delimiter(',')->capture_default_str();
  app.add_option("--queries", count, "In each room")->capture_default_str();
  ExperimentOptions wanted(app, "results.csv, prices.csv and plots", "The first room only, up to 1,024 rays",
                           "Compare errors with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  CsvTable table{
      {"triangles", "method", "rays", "queries", "rms_error", "largest_error", "claimed_error", "seconds_a_query"}, {}};
  CsvTable prices{{"triangles", "method", "power_of_N", "exact_costs_rays", "error_at_exact_price", "price_at_1e-2",
                   "price_at_1e-3", "price_at_1e-4"},
                  {}};
  if (wanted.reduced()) rooms.resize(1);
  for (const std::int64_t triangles : rooms) {
    Plot plot{fmt::format("Partly visible polygons in a room of {} triangles", triangles),
              "seconds a query (one thread)", "rms error / unoccluded form factor"};
    plot.note = plot_note();
    answer(triangles, count, wanted.reduced() ? 1024 : kMostRays, table, prices, wanted.writes() ? &plot : nullptr);
    if (!wanted.writes()) continue;
    const std::filesystem::path folder = wanted.folder();
    table.write(folder / "results.csv");
    prices.write(folder / "prices.csv");
    write_plot(folder / fmt::format("plot_{}.svg", triangles), plot);
  }
  // Proven bounds are no errors. Embree's arithmetic may differ between processors: single rays at edges count.
  std::erase_if(table.rows, [](const auto& row) { return row[1] == "exact"; });
  return wanted.check(table, 4, 0.25, {"largest_error", "claimed_error", "seconds_a_query"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
