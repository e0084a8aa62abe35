// exitance compare: form factors by exact visibility, by rays and by other programs against the truth.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>

#include "src/cli/compare_report.h"
#include "src/cli/console.h"
#include "src/cli/contender_names.h"
#include "src/cli/given_options.h"
#include "src/cli/interrupt.h"
#include "src/cli/memory_limit.h"
#include "src/cli/number_range.h"
#include "src/cli/progress_display.h"
#include "src/cli/ray_settings.h"
#include "src/cli/scene_options.h"
#include "src/cli/verbs.h"
#include "src/form_factor/pair_run.h"
#include "src/output/faces.h"
#include "src/output/process_memory.h"
#include "src/output/run_clock.h"
#include "src/output/vtk.h"
#include "src/reference/comparison.h"
#include "src/reference/matrix_solution.h"
#include "src/scene/input_error.h"
#include "src/scene/scene_hash.h"
#include "src/solve/radiosity_system.h"

namespace exitance {
namespace {

std::uint64_t bytes_of(const FormFactorMatrix& F) {
  return F.row_first.size() * sizeof(F.row_first[0]) +
         F.F.size() * (sizeof(F.column[0]) + sizeof(F.F[0]) + sizeof(F.F_error[0]));
}

/// Faults by their numbers, in words.
std::string all_reasons() {
  std::string text;
  for (std::uint8_t k = 0; k <= static_cast<std::uint8_t>(Fault::unknown); ++k)
    text += fmt::format("{}{} {}", k == 0 ? "" : "; ", k, describe(static_cast<Fault>(k)));
  return text;
}

/// A scene cut into patches of one element each.
struct Subject {
  Subject(const Scene& of_scene, const MeshOptions& options)
      : scene(of_scene), soup(make_soup(scene)), mesh(make_patch_mesh(scene, soup, options)), exchange(soup, mesh) {
    if (mesh.patches.empty()) throw InputError(scene.name, 0, "no surface has an area; there is nothing to compare");
  }
  Subject(const Subject&) = delete;
  Subject& operator=(const Subject&) = delete;

  const Scene& scene;
  PolygonSoup soup;
  PatchMesh mesh;
  ExchangeScene exchange;
};

class Compare {
 public:
  explicit Compare(CLI::App& verb) : verb_(verb) {
    scene_.add_to(verb);
    verb.add_option("--against", names_,
                    "Contenders, separated by commas: rays:N, rays:N:SAMPLER:ESTIMATOR:fast:untold, exact:TOLERANCE, "
                    "or a matrix file (.h5, .csv, or View3D's .txt)")
        ->delimiter(',')
        ->required();
    verb.add_option("--reference", reference_, "Solution that B is compared with, too: of `reference` or `solve`");
    verb.add_option("--tolerance", truth_.tolerance, "Of the exact form factors that are the truth")
        ->check(positive_number())
        ->capture_default_str();
    verb.add_option("--patch-size", patch_size_, "Longest edge of a patch [m]; 0: surfaces as they are")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_option("--worst", worst_, "Pairs that are listed of each contender")
        ->check(whole_number_between(0, 1'000'000))
        ->capture_default_str();
    verb.add_option("--ray-offset", rays_.offset, "Both ends of rays off their surfaces, of the scene's radius")
        ->check(number_between(0, 1))
        ->capture_default_str();
    verb.add_option("--replicates", rays_.replicates,
                    "Independent estimates by so many rays, of which the mean is taken; their spread gives the error")
        ->check(whole_number_between(1, kMostRays))
        ->capture_default_str();
    verb.add_option("--seed", rays_.seed, "Of rays")->check(whole_number_between(0))->capture_default_str();
    verb.add_option("--threads", threads_, "Threads; as many as there are cores unless given")
        ->check(whole_number_between(1, kMostThreads));
    memory_limit_.add_to(verb);
    verb.add_option("--save-every", save_every_,
                    "Seconds of work after which finished rows of the truth are saved beside FILE")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_option(
        "-o,--output", file_,
        "File for the patches of the worst pairs (.vtp); rows of the truth are kept in FILE.parts until then, "
        "from where the same command goes on");
    verb.add_flag("--json", json_, "Print the report as JSON");
    verb.footer(
        "Form factors are means over patches. SAMPLER: sobol (default), owen, stratified, random. ESTIMATOR: kernel\n"
        "(default), fraction, hemisphere, centre. Both are those of solve --visibility rays. fast: without Embree's "
        "robust\n"
        "mode; untold: rays are not told of contacts. Times are of one run of this program, so that their ratios "
        "count.\n"
        "\"std. error\" is what rays say of themselves, in the mean and of each pair; \"beyond 3\" the share of pairs "
        "that are\n"
        "wrong by more than three of it. FILE.vtp has for each patch of a worst pair: contender (its place\n"
        "in --against, from 0), rank (from 1), source (0: receiver), F, truth, difference, reason: " +
        all_reasons() + ".");
  }

  void run() {
    const std::size_t threads =
        threads_ ? *threads_ : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    catch_interrupts();
    const std::vector<Contender> contenders = contenders_named(names_, rays_);
    const Scene scene = scene_.read();
    for (const std::string& warning : scene.warnings) print_warning(warning);
    const Subject subject(scene, {.patch_size = patch_size_, .memory_limit = memory_limit_.bytes()});
    refuse_what_does_not_fit(subject.exchange);
    if (!reference_.empty()) reference_record_ = read_solution(reference_);
    describe(subject, threads);

    // What other programs made is read first, so that a wrong file ends the run at once.
    std::vector<std::optional<ContenderRun>> runs(contenders.size());
    for (std::size_t k = 0; k < runs.size(); ++k) {
      if (contenders[k].maker() == Maker::unknown) runs[k] = run_one(contenders[k], subject);
    }
    find_truth(subject);
    for (std::size_t k = 0; k < runs.size(); ++k) {
      if (!runs[k]) runs[k] = run_one(contenders[k], subject);
      judge(contenders[k], *runs[k], subject);
      runs[k].reset();
    }
    if (!file_.empty()) write_worst(subject);
    if (checkpoint_) checkpoint_->remove();
    print_results(json_ ? to_json(report_) : printable(in_words(report_)));
  }

 private:
  void describe(const Subject& subject, std::size_t threads) {
    report_.scene = subject.scene.name;
    report_.scene_hash = scene_hash(subject.scene);
    report_.reference = reference_;
    report_.patches = subject.exchange.size();
    report_.patch_size = patch_size_;
    report_.truth_tolerance = truth_.tolerance;
    report_.threads = static_cast<unsigned>(threads);
    report_.options = given_options(verb_);
    report_.warnings = subject.scene.warnings;
  }

  /// The truth with its classes, and one contender at a time.
  void refuse_what_does_not_fit(const ExchangeScene& exchange) const {
    const std::uint64_t n = exchange.size();
    exitance::refuse_what_does_not_fit(n, 2 * pair_rows_bytes(n, expected_pair_density(exchange)) + n * n,
                                       memory_limit_.bytes());
  }

  ContenderRun run_one(const Contender& contender, const Subject& subject) const {
    ProgressDisplay display;
    return exitance::run(
        contender, subject.mesh, subject.exchange,
        [&](double fraction, std::string_view) { display.show(fraction, contender.name); }, interrupted);
  }

  void find_truth(const Subject& subject) {
    ProgressDisplay display;
    const RunClock clock;
    if (!file_.empty()) checkpoint_.emplace(file_ + ".parts", pair_run_key(report_.scene_hash, patch_size_, truth_));
    const PairRun rows =
        run_pairs(subject.exchange,
                  {.pairs = truth_,
                   .block_seconds = save_every_,
                   .progress = [&](double fraction, std::string_view) { display.show(fraction, "truth"); }},
                  checkpoint_ ? &*checkpoint_ : nullptr);
    if (!rows.complete) {
      throw LimitError(fmt::format("stopped before the truth was known; {}",
                                   checkpoint_ ? fmt::format("{} of its {} rows are kept in {}.parts, from where the "
                                                             "same command goes on",
                                                             rows.finished, subject.exchange.size(), file_)
                                               : "its rows are lost, as they are kept only with -o"));
    }
    report_.truth_resumed_rows = rows.resumed;
    truth_matrix_ = truth_of(rows.rows, static_cast<std::uint32_t>(subject.exchange.size()));
    report_.truth_seconds = clock.seconds();
    report_.truth_cpu_seconds = clock.cpu_seconds();
    report_.truth_queries = rows.statistics.points;
    report_.truth_unreached = rows.unreached();
    for (const double error : truth_matrix_.F.F_error)
      report_.truth_largest_error = std::max(report_.truth_largest_error, error);
    for (const PairClass kind : truth_matrix_.kind) ++report_.pairs[static_cast<std::size_t>(kind)];
    truth_solution_ = solve_matrix(subject.scene, subject.soup, subject.mesh, truth_matrix_.F);
    if (reference_record_) report_.truth_B_reference = errors_of(*reference_record_, truth_solution_);
  }

  static CompareReport::SolutionErrors errors_of(const SolutionRecord& reference, const SolutionRecord& current) {
    const Comparison comparison = compare(reference, current);
    return {comparison.error, comparison.error_worst_1_percent};
  }

  void judge(const Contender& contender, const ContenderRun& run, const Subject& subject) {
    CompareReport::Entry entry{.name = contender.name,
                               .errors = compare(truth_matrix_, run.F, worst_, run.standard_errors),
                               .faults = {},
                               .why_no_solution = {},
                               .B = {},
                               .B_reference = {},
                               .standard_error = run.standard_error,
                               .rays = run.rays,
                               .queries = run.queries,
                               .matrix_bytes = bytes_of(run.F),
                               .peak_memory_bytes = peak_memory_bytes(),
                               .seconds = run.seconds,
                               .cpu_seconds = run.cpu_seconds};
    if (!entry.errors.worst.empty()) {
      const FaultFinder finder(contender, subject.mesh, subject.exchange);
      for (const WorstPair& w : entry.errors.worst)
        entry.faults.push_back(finder.find(w, truth_matrix_.kind[w.i * truth_matrix_.patches() + w.j]));
    }
    try {
      const SolutionRecord solution = solve_matrix(subject.scene, subject.soup, subject.mesh, run.F);
      entry.B = errors_of(truth_solution_, solution);
      if (reference_record_) entry.B_reference = errors_of(*reference_record_, solution);
    } catch (const InvalidSystem& wrong) {
      entry.why_no_solution = wrong.what();
    }
    report_.entries.push_back(std::move(entry));
  }

  /// Both patches of each pair, with what is wrong between them.
  void write_worst(const Subject& subject) const {
    struct Side {
      std::uint32_t patch;
      double contender, rank, source, F, truth, error, reason;
    };
    std::vector<Side> sides;
    for (std::size_t c = 0; c < report_.entries.size(); ++c) {
      const std::vector<WorstPair>& worst = report_.entries[c].errors.worst;
      for (std::size_t k = 0; k < worst.size(); ++k) {
        const WorstPair& w = worst[k];
        for (const bool source : {false, true}) {
          sides.push_back({source ? w.j : w.i, static_cast<double>(c), static_cast<double>(k + 1), source ? 1.0 : 0.0,
                           w.F, w.truth, w.F - w.truth, static_cast<double>(report_.entries[c].faults[k])});
        }
      }
    }
    const PatchMesh& mesh = subject.mesh;
    std::ranges::stable_sort(sides, {}, [&](const Side& s) { return mesh.patches[s.patch].surface; });
    Faces faces(0);
    std::vector<std::vector<double>> values(7);
    for (std::uint32_t k = 0; k < sides.size(); ++k) {
      const Side& s = sides[k];
      for (const ExchangeScene::Piece& piece : subject.exchange.pieces(s.patch))
        faces.add(mesh.patches[s.patch].surface, s.patch, k, piece.radiator.facets()[0].loop);
      const std::array<double, 7> row{s.contender, s.rank, s.source, s.F, s.truth, s.error, s.reason};
      for (std::size_t v = 0; v < row.size(); ++v) values[v].push_back(row[v]);
    }
    const std::vector<VtkArray> arrays = {{"contender", "", {}, values[0]}, {"rank", "", {}, values[1]},
                                          {"source", "", {}, values[2]},    {"F", "", {}, values[3]},
                                          {"truth", "", {}, values[4]},     {"difference", "", {}, values[5]},
                                          {"reason", "", {}, values[6]}};
    write_vtp(file_, faces, arrays);
  }

  CLI::App& verb_;
  SceneOptions scene_;
  std::vector<std::string> names_;
  RayOptions rays_;
  PairOptions truth_{.tolerance = 1e-10, .stop = interrupted};
  double patch_size_ = 0, save_every_ = 2;
  std::size_t worst_ = 10;
  std::optional<std::size_t> threads_;
  MemoryLimit memory_limit_;
  std::string reference_, file_;
  bool json_ = false;

  std::optional<SolutionRecord> reference_record_;
  std::optional<Checkpoint> checkpoint_;
  MatrixTruth truth_matrix_;
  SolutionRecord truth_solution_;
  CompareReport report_;
};

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("compare", "Compare form factors by rays and by other programs with exact ones");
  verb->callback([compare = std::make_shared<Compare>(*verb)] { compare->run(); });
}

}  // namespace exitance
