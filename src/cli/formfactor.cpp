// exitance formfactor: the form factors between all patches of a scene.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numeric>
#include <optional>
#include <string>

#include "src/cli/console.h"
#include "src/cli/formfactor_report.h"
#include "src/cli/given_options.h"
#include "src/cli/interrupt.h"
#include "src/cli/memory_limit.h"
#include "src/cli/number_range.h"
#include "src/cli/progress_display.h"
#include "src/cli/scene_options.h"
#include "src/cli/verbs.h"
#include "src/form_factor/pair_run.h"
#include "src/form_factor/row_closing.h"
#include "src/output/manifest.h"
#include "src/output/process_memory.h"
#include "src/reference/matrix_file.h"
#include "src/reference/matrix_triplets.h"
#include "src/scene/front_view.h"
#include "src/scene/input_error.h"
#include "src/scene/scene_check.h"
#include "src/scene/scene_hash.h"

namespace exitance {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// So many partial pairs are integrated again, each with so many points at most.
constexpr std::size_t kSampledPairs = 64;
constexpr std::uint64_t kSamplePoints = 20'000;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A scene cut into patches.
struct Patches {
  Patches(const Scene& of_scene, const MeshOptions& options)
      : scene(of_scene), soup(make_soup(scene)), mesh(make_patch_mesh(scene, soup, options)), exchange(soup, mesh) {
    if (mesh.patches.empty()) throw InputError(scene.name, 0, "no surface has an area; there is nothing to compute");
  }
  Patches(const Patches&) = delete;
  Patches& operator=(const Patches&) = delete;

  /// Of all surfaces that are no mere obstructions, those that have no row.
  std::size_t surfaces_without_area() const {
    std::vector<bool> has_patch(scene.surfaces.size());
    for (const Patch& patch : mesh.patches) has_patch[patch.surface] = true;
    std::size_t count = 0;
    for (std::size_t s = 0; s < has_patch.size(); ++s) count += !has_patch[s] && !scene.surfaces[s].obstruction_only;
    return count;
  }

  /// A row a patch, in file order; the patches of one group of surfaces have one row, however they were cut.
  MatrixRecord record_of(FormFactorMatrix matrix, const std::string& mesh_hash) const {
    MatrixRecord record{.matrix = std::move(matrix), .mesh_hash = mesh_hash};
    std::vector<std::uint32_t> groups;
    for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
      const Surface& surface = scene.surfaces[mesh.patches[p].surface];
      const std::vector<double>& rho = scene.materials[surface.material].rho;
      record.area.push_back(exchange.area(p));
      record.emissivity.push_back(1 - std::accumulate(rho.begin(), rho.end(), 0.0) / static_cast<double>(rho.size()));
      record.name.push_back(scene.objects[surface.object].name);
      groups.push_back(surface.group);
    }
    const bool any = std::ranges::any_of(groups, [](std::uint32_t group) { return group != kNoGroup; });
    return any ? combine(record, make_groups(groups)) : record;
  }

  const Scene& scene;
  PolygonSoup soup;
  PatchMesh mesh;
  ExchangeScene exchange;
};

class FormFactor {
 public:
  explicit FormFactor(CLI::App& verb) : verb_(verb) {
    scene_.add_to(verb);
    verb.add_option("--tolerance", pairs_.tolerance, "Absolute error wanted of form factors")->check(positive_number());
    verb.add_option("--relative", pairs_.relative, "An error within this share of its form factor is good enough, too")
        ->check(number_between(0, 1))
        ->capture_default_str();
    verb.add_option("--patch-size", patch_size_, "Longest edge of a patch [m]; 0: surfaces as they are")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_option("--threads", threads_, "Threads; as many as there are cores unless given")
        ->check(whole_number_between(1, kMostThreads));
    memory_limit_.add_to(verb);
    verb.add_option("--save-every", save_every_, "Seconds of work after which finished rows are saved beside FILE")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_option("--seed", seed_, "Of the pairs that are integrated again as a check")
        ->check(whole_number_between(0))
        ->capture_default_str();
    verb.add_flag(
        "--close-rows", close_rows_,
        "Of a closed scene, write a second file (FILE with .closed before its extension) whose rows sum to 1");
    verb.add_flag("--json", json_, "Print the report as JSON");
    verb.add_option("-o,--output", file_,
                    "File for the matrix: .h5 (values and errors), .csv (i,j,F,F_error) or .txt (View3D's layout); CSV "
                    "on standard output without it");
    verb.footer(fmt::format(
        "The default tolerance is {:g} absolute. A row a patch, in file order, obstructions and surfaces without area\n"
        "left out; combined surfaces have one row at any patch size. Finished rows are kept in FILE.parts: the same\n"
        "command goes on after Ctrl-C (exit code 4) or a crash. Exit code 1: rows, reciprocity or single entries are\n"
        "off by more than their errors; the matrix is saved all the same. Nothing is ever normalised; --close-rows\n"
        "scales F_ij by d_i d_j.",
        pairs_.tolerance));
  }

  void run() {
    const auto start = Clock::now();
    if (file_.empty() && json_) throw CLI::ValidationError("--json", "needs -o, as the matrix is on standard output");
    if (file_.empty() && close_rows_) throw CLI::ValidationError("--close-rows", "needs -o");
    if (!file_.empty()) matrix_format(file_);
    const std::size_t threads =
        threads_ ? *threads_ : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    catch_interrupts();

    const Scene scene = scene_.read();
    report_.available_bytes = memory_limit_.bytes();
    const Patches patches(scene, {.patch_size = patch_size_, .memory_limit = report_.available_bytes});
    describe(patches);
    report_.threads = static_cast<unsigned>(threads);
    report_.seconds.load = seconds_since(start);
    const PairRun rows = compute(patches);

    auto before = Clock::now();
    const MatrixRecord record = checked(patches, rows);
    report_.seconds.checks = seconds_since(before);
    before = Clock::now();
    write(record);
    report_.seconds.output = seconds_since(before);
    report_.seconds.total = seconds_since(start);
    report_.peak_memory_bytes = peak_memory_bytes();
    if (checkpoint_) checkpoint_->remove();
    end();
  }

 private:
  void describe(const Patches& patches) {
    const Scene& scene = patches.scene;
    report_.scene = scene.name;
    report_.scene_hash = scene_hash(scene);
    report_.surfaces = scene.surfaces.size();
    report_.patches = patches.mesh.patches.size();
    report_.patch_size = patch_size_;
    report_.tolerance = pairs_.tolerance;
    report_.relative = pairs_.relative;
    report_.file = file_;
    report_.seed = seed_;
    report_.options = given_options(verb_);
    report_.warnings = scene.warnings;
    if (const std::size_t count = patches.surfaces_without_area(); count > 0)
      report_.warnings.push_back(fmt::format("{} surfaces have no area and no row", count));
    for (const std::string& warning : report_.warnings) print_warning(warning);
    report_.closed = is_closed(scene);
    report_.only_fronts = report_.closed && sees_only_fronts(scene);
    if (close_rows_ && !report_.closed)
      throw InputError(scene.name, 0, "the scene is open, so that its rows need not sum to 1; leave out --close-rows");
  }

  void refuse_what_does_not_fit(const ExchangeScene& scene) {
    report_.estimated_bytes = pair_rows_bytes(scene.size(), expected_pair_density(scene));
    fmt::print(stderr, "memory: about {} for the form factors of {} patches, beside {} for the scene\n",
               size_in_words(report_.estimated_bytes), scene.size(), size_in_words(peak_memory_bytes()));
    exitance::refuse_what_does_not_fit(scene.size(), report_.estimated_bytes, report_.available_bytes);
  }

  PairRun compute(const Patches& patches) {
    refuse_what_does_not_fit(patches.exchange);
    const auto start = Clock::now();
    if (!file_.empty()) checkpoint_.emplace(file_ + ".parts", pair_run_key(report_.scene_hash, patch_size_, pairs_));
    PairRun rows;
    {
      ProgressDisplay display;
      rows = run_pairs(patches.exchange,
                       {.pairs = pairs_,
                        .block_seconds = save_every_,
                        .progress = [&](double fraction, std::string_view label) { display.show(fraction, label); }},
                       checkpoint_ ? &*checkpoint_ : nullptr);
    }
    if (!rows.complete) stop(rows.finished);
    report_.pairs = pairs_by_class(rows.rows, patches.exchange.size());
    report_.class_seconds = rows.statistics.seconds;
    report_.points = rows.statistics.points;
    report_.unreached = rows.unreached();
    report_.resumed_rows = rows.resumed;
    report_.seconds.form_factors = seconds_since(start);
    return rows;
  }

  [[noreturn]] void stop(std::uint32_t finished) const {
    throw LimitError(
        fmt::format("stopped after {} of {} rows; {}", finished, report_.patches,
                    checkpoint_ ? fmt::format("they are kept in {}.parts, from where the same command goes on", file_)
                                : "they are lost, as rows are kept only with -o"));
  }

  MatrixRecord checked(const Patches& patches, const PairRun& rows) {
    PairOptions sampled = pairs_;
    sampled.points = kSamplePoints;
    report_.sample = sample_pairs(patches.exchange, rows.rows, sampled, kSampledPairs, seed_);
    if (!report_.sample.complete) stop(rows.finished);
    const std::string hash =
        report_.scene_hash + (patch_size_ > 0 ? fmt::format(" in patches of {} m", patch_size_) : "");
    MatrixRecord record =
        patches.record_of(matrix_of(rows.rows, static_cast<std::uint32_t>(patches.exchange.size())), hash);
    report_.rows = record.matrix.rows();
    report_.entries = record.matrix.F.size();
    report_.row_names = record.name;
    report_.matrix = check_matrix(record.matrix, record.area);
    record.manifest = matrix_manifest(report_);
    return record;
  }

  void write(const MatrixRecord& record) {
    if (file_.empty()) {
      write_triplets(std::cout, record.matrix);
      print_results("");
      return;
    }
    write_matrix(file_, record);
    if (close_rows_) write_closed(record);
  }

  void write_closed(MatrixRecord record) {
    std::optional<ClosedRows> closed = close_rows(record.matrix);
    if (!closed) return;
    fs::path path = file_;
    path.replace_extension(".closed" + path.extension().string());
    report_.closed_file = path.string();
    report_.rows_closed = {closed->largest_change, closed->largest_factor, closed->row, closed->column};
    record.matrix = std::move(closed->matrix);
    record.manifest = matrix_manifest(report_);
    write_matrix(path, record);
  }

  void end() const {
    if (file_.empty()) {
      fmt::print(stderr, "{}", printable(in_words(report_)));
    } else {
      print_results(json_ ? to_json(report_) : printable(in_words(report_)));
    }
    std::vector<std::string> failed = failed_checks(report_);
    if (close_rows_ && !report_.rows_closed)
      failed.push_back("no scaling makes all rows sum to 1; the second file was not written");
    for (const std::string& line : failed) print_message(line);
    if (!failed.empty()) throw CLI::RuntimeError(check_failed);
  }

  CLI::App& verb_;
  SceneOptions scene_;
  PairOptions pairs_{.tolerance = 1e-9, .stop = interrupted};
  double patch_size_ = 0, save_every_ = 2;
  std::optional<std::size_t> threads_;
  MemoryLimit memory_limit_;
  std::uint64_t seed_ = 1;
  bool close_rows_ = false, json_ = false;
  std::string file_;

  std::optional<Checkpoint> checkpoint_;
  FormFactorReport report_;
};

}  // namespace

void add_formfactor(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("formfactor", "Compute the form factors between all patches of a scene");
  verb->callback([formfactor = std::make_shared<FormFactor>(*verb)] { formfactor->run(); });
}

}  // namespace exitance
