#include "src/cli/link_frames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>

#include "src/cli/progress_display.h"
#include "src/cli/stations.h"
#include "src/links/hierarchical_solution.h"
#include "src/output/image.h"
#include "src/output/mesh_faces.h"
#include "src/solve/scene_solution.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

const std::map<std::string, LinkMethod> kMethods = {{"rebuild", LinkMethod::rebuild},
                                                    {"direct", LinkMethod::direct},
                                                    {"hvt", LinkMethod::hvt},
                                                    {"hvt-peu", LinkMethod::hvt_peu}};

class Frames {
 public:
  Frames(const DynamicScene& given, const LinkFrameOptions& options, const std::filesystem::path& folder)
      : given_(given), options_(options), folder_(folder), links_(given.scene, options.links) {
    moves_.resize(given.scene.objects.size());
    for (const Event& event : given.events) moves_[event.edit.object] = 1;
    name_ = std::ranges::find(kMethods, options.method, [](const auto& entry) { return entry.second; })->first;
  }

  LinksEnd follow() {
    const std::vector<Station> stations = stations_of(given_.events);
    const auto show_progress = [&](std::size_t frame) {
      display_.show(static_cast<double>(frame) / static_cast<double>(stations.size()), "frames");
    };
    show_progress(0);
    const LinkUpdate built = links_.build(interruption(false));
    add(stations.front(), built);
    bool left = false;  // something, by the last update
    stopped_ = stopped_ || built.stopped;
    for (std::size_t k = 1; k < stations.size() && !(options_.stop && options_.stop()); ++k) {
      show_progress(k);
      std::vector<Edit> edits;
      for (std::size_t e = stations[k].first; e < stations[k].last; ++e) edits.push_back(given_.events[e].edit);
      const LinkUpdate update = links_.update(edits, options_.method, interruption());
      const Obstacles& obstacles = links_.obstacles();
      display_.clear();
      warn_of_trespass(options_.path, lines_of_edits(given_, stations[k]), links_.scene(), obstacles.soup(),
                       obstacles.facets());
      add(stations[k], update);
      left = update.pairs_left > 0;
      stopped_ = stopped_ || update.stopped;
    }
    if (left && options_.work_off && !(options_.stop && options_.stop())) {
      const LinkUpdate rest = links_.work_off(interruption(false));
      add(working_off(stations.back()), rest);
      left = rest.pairs_left > 0;
    }
    const bool unfinished = stopped_ || (left && !options_.budget);
    return unfinished ? LinksEnd::unfinished : LinksEnd::finished;
  }

 private:
  /// From now on.
  LinkInterruption interruption(bool by_budget = true) const {
    LinkInterruption how;
    by_budget = by_budget && options_.budget;
    if (!by_budget) how.order = LinkOrder::any;
    const auto start = std::chrono::steady_clock::now();
    how.abandon = options_.abandon;
    how.stop = [this, start, by_budget] {
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      return (by_budget && spent.count() >= *options_.budget) || (options_.stop && options_.stop());
    };
    return how;
  }

  void add(const Station& station, const LinkUpdate& update) {
    const std::vector<std::string> edits = names_of_edits(given_, station);
    const std::vector<std::uint32_t> elements = links_.elements();
    const std::span<const double> B = links_.radiosity().B();
    std::optional<ConvergenceError> error;
    if (options_.references) {
      try {
        const std::vector<double> reference = links_.converged(options_.abandon);
        error = link_error(links_.tree(), elements, links_.radiosity().bands(), reference, reference_before_, B);
        reference_before_ = reference;
      } catch (const Abandoned&) {  // the frame itself is whole
        stopped_ = true;
      }
    }
    const ConvergenceError left = left_undone(elements);
    const SightWork& sight = update.work.sight;
    const LinkCounts counts = links_.links().count(links_.tree(), moves_);
    const std::vector<std::uint8_t> used = links_.nodes_in_use();
    std::size_t patches = 0;
    for (const Root& root : links_.tree().roots()) patches += root.present;
    Json frame;
    frame["frame"] = result_.frames.size();
    frame["time"] = station.time;
    frame["edits"] = edits;
    frame["method"] = name_;
    frame["seconds"] = update.seconds;
    frame["links_updated"] = update.work.links_updated;
    frame["links_affected"] = update.work.links_affected;
    frame["skipped"] = update.work.skipped;
    frame["pairs_left"] = update.pairs_left;
    frame["finished"] = !update.stopped && update.pairs_left == 0 && update.exchange.converged;
    frame["refined"] = update.work.refined;
    frame["unrefined"] = update.work.unrefined;
    frame["form_factors"] = sight.form_factors;
    frame["visibility_tests"] = sight.visibility_tests;
    frame["shaft_tests"] = sight.shaft_tests;
    frame["error"] = error ? Json(error->all) : Json(nullptr);
    frame["error_worst_1_percent"] = error ? Json(error->worst_1_percent) : Json(nullptr);
    frame["left_undone"] = left.all;
    frame["left_undone_worst_1_percent"] = left.worst_1_percent;
    frame["seconds_scene"] = update.seconds_scene;
    frame["seconds_links"] = update.seconds_links;
    frame["seconds_exchange"] = update.seconds_exchange;
    frame["cpu_seconds"] = update.cpu_seconds;
    // Wall clock, too: to ask for a thread's processor time so often would take longer than most of what it is of.
    frame["thread_seconds"] = {{"form_factors", sight.seconds_form_factors},
                               {"visibility", sight.seconds_visibility},
                               {"shafts", sight.seconds_shafts}};
    frame["exchange_iterations"] = update.exchange.iterations;
    frame["patches"] = patches;
    frame["sub_patches"] = std::ranges::count(used, 1);
    frame["elements"] = elements.size();
    frame["links"] = {{"active", counts.active},   {"shadow", counts.shadow}, {"ghost", counts.ghost},
                      {"E-E", counts.environment}, {"E-O", counts.mixed},     {"O-O", counts.dynamic},
                      {"bytes", counts.bytes}};
    frame["unit"] = given_.scene.unit;
    if (options_.images) draw(station.time, elements);
    result_.summary += fmt::format(
        "frame {:3}  {:>9.4f} s  {:7} of {} links  {}  {}{}\n", result_.frames.size(), update.seconds,
        update.work.links_updated, counts.links(), in_words(error),
        left.all > 0 ? fmt::format("left undone {:.2g}, of the 1 % {:.2g}  ", left.all, left.worst_1_percent) : "",
        fmt::join(edits, ", "));
    result_.frames.push_back(std::move(frame));
    options_.finished(result_);
  }

  /// Of what updates have left as it was, as if all of it were missing.
  ConvergenceError left_undone(std::span<const std::uint32_t> elements) const {
    std::vector<double> most = links_.left_as_it_was();
    if (most.empty()) return {};
    const std::span<const double> Y = links_.radiosity().luminance();
    std::ranges::transform(most, Y, most.begin(), std::plus());
    return link_error(links_.tree(), elements, 1, most, Y, Y);
  }

  void draw(double time, const std::vector<std::uint32_t>& elements) const {
    const PatchMesh mesh = mesh_of(links_);
    const Faces faces = faces_of(mesh, links_.obstacles().soup());
    const std::uint32_t bands = links_.radiosity().bands();
    std::vector<double> B;
    std::vector<std::uint8_t> emits, covered;
    for (const std::uint32_t n : elements) {
      const std::uint32_t root = links_.tree().node(n).root;
      const auto E = links_.radiosity().E().subspan(std::size_t{root} * bands, bands);
      for (std::uint32_t b = 0; b < bands; ++b) B.push_back(links_.radiosity().whole_B(n, b));
      emits.push_back(std::ranges::any_of(E, [](double value) { return value > 0; }));
    }
    write_frame(folder_, given_, {result_.frames.size(), time, faces, bands, B}, [&](const Camera& camera) {
      return render(faces, {bands, B, emits, covered}, camera, {options_.image_size, options_.image_size});
    });
  }

  const DynamicScene& given_;
  const LinkFrameOptions& options_;
  std::filesystem::path folder_;
  LinkedRadiosity links_;
  ProgressDisplay display_;
  std::vector<std::uint8_t> moves_;
  std::string name_;
  std::vector<double> reference_before_;
  bool stopped_ = false;  ///< what built everything, or the search for a reference
  FrameList result_;
};

}  // namespace

std::optional<LinkMethod> link_method_named(const std::string& name) {
  const auto found = kMethods.find(name);
  return found == kMethods.end() ? std::nullopt : std::optional(found->second);
}

LinksEnd follow_links(const DynamicScene& given, const LinkFrameOptions& options, const std::filesystem::path& folder) {
  try {
    return Frames(given, options, folder).follow();
  } catch (const Abandoned&) {
    return LinksEnd::unfinished;
  }
}

}  // namespace exitance
