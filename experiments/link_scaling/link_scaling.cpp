// How do time and memory of links, and of an edit of them, grow with their number? After Feng, Chang, Shen and Yang.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/link_scene.h"
#include "experiments/plot_note.h"
#include "experiments/power_law.h"
#include "src/output/plot.h"

namespace exitance {
namespace {

struct Series {
  std::string scene;
  std::vector<double> shares;  ///< of the eps2 and the smallest area in the scene file, falling
};

struct Tables {
  CsvTable links{{"scene", "share_of_thresholds", "links", "sub_patches", "E-E", "E-O", "O-O", "bytes_per_record",
                  "bytes_per_link", "bytes_per_link_after_edit", "seconds_build", "links_per_second",
                  "affected_by_edit", "updated_by_hvt", "seconds_hvt"},
                 {}};
  Plot plot{"Links: building and updating", "links", "processor seconds"};
};

void measure(const Series& series, bool reduced, Tables& tables) {
  const LinkScene scene(series.scene);
  Curve build, hvt;
  for (const double share : series.shares) {
    LinkedRadiosity radiosity(scene.given.scene, scene.options(share, share));
    const LinkUpdate built = radiosity.build();
    const LinkCounts counts = radiosity.links().count(radiosity.tree(), scene.moves);
    const auto sub_patches = std::ranges::count(radiosity.nodes_in_use(), 1);
    const LinkUpdate edited = radiosity.update(scene.edits, LinkMethod::hvt);
    const LinkCounts after = radiosity.links().count(radiosity.tree(), scene.moves);
    const auto links = static_cast<double>(counts.links());
    const auto part = [&](std::uint64_t n) { return digits(static_cast<double>(n) / links); };
    tables.links.rows.push_back(
        {reduced ? series.scene + " reduced" : series.scene, digits(share), fmt::format("{}", counts.links()),
         fmt::format("{}", sub_patches), part(counts.environment), part(counts.mixed), part(counts.dynamic),
         digits(static_cast<double>(counts.bytes) / (links + static_cast<double>(counts.ghost))),
         digits(static_cast<double>(counts.bytes) / links),
         digits(static_cast<double>(after.bytes) / static_cast<double>(after.links())), digits(built.cpu_seconds),
         digits(links / built.cpu_seconds), part(edited.work.links_affected), part(edited.work.links_updated),
         digits(edited.cpu_seconds)});
    build.emplace_back(links, built.cpu_seconds);
    hvt.emplace_back(links, edited.cpu_seconds);
    fmt::print(stderr, "{}, {} links: built in {:.3f} s, updated in {:.4f} s\n", series.scene, counts.links(),
               built.cpu_seconds, edited.cpu_seconds);
  }
  tables.plot.series.push_back({fmt::format("{}, build: slope {:.2f}", series.scene, slope(build)), build});
  tables.plot.series.push_back({fmt::format("{}, update by HVT: slope {:.2f}", series.scene, slope(hvt)), hvt});
}

int run(int argc, char** argv) {
  CLI::App app{"Building and updating links, from 10,000 to 10,000,000"};
  ExperimentOptions wanted(app, "results.csv and plot.svg", "Box only, with few links",
                           "Compare counts and shares with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  Tables tables;
  tables.plot.note = plot_note();
  if (wanted.reduced()) {
    measure({"box", {8, 4}}, wanted.reduced(), tables);
  } else {
    measure({"box", {5, 2, 1, 0.5, 0.25, 0.055}}, wanted.reduced(), tables);
    measure({"hall", {16, 4, 1, 0.5, 0.11}}, wanted.reduced(), tables);
  }
  if (wanted.writes()) {
    tables.links.write(wanted.folder() / "results.csv");
    write_plot(wanted.folder() / "plot.svg", tables.plot);
  }
  return wanted.check(tables.links, 2, 0.02, {"seconds_build", "links_per_second", "seconds_hvt"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
