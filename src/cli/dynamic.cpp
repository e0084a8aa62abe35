// exitance dynamic: the radiosity of a scene in which objects come, go, move and change.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src/cli/console.h"
#include "src/cli/given_options.h"
#include "src/cli/interrupt.h"
#include "src/cli/json_text.h"
#include "src/cli/link_frames.h"
#include "src/cli/link_settings.h"
#include "src/cli/memory_limit.h"
#include "src/cli/number_range.h"
#include "src/cli/shot_frames.h"
#include "src/cli/verbs.h"
#include "src/output/checkpoint.h"
#include "src/output/result_folder.h"
#include "src/output/whole_file.h"
#include "src/scene/input_error.h"
#include "src/scene/scene_file.h"
#include "src/scene/scene_hash.h"

namespace exitance {
namespace {

/// Options that change nothing of the work, or the path of a scene, whose contents count.
constexpr std::array<std::string_view, 7> kOfNoConsequence = {"SCENE",      "json",       "output", "references",
                                                              "save-every", "time-limit", "threads"};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Which methods look at an option. What is not here has a meaning for all.
using Methods = std::vector<std::string>;
const Methods kByShots = {"scratch", "restart", "redistribute"}, kByLinks = {"rebuild", "direct", "hvt", "hvt-peu"};
const std::vector<std::pair<const char*, Methods>> kMethodsOfOptions = {
    {"--strategy", {"restart", "redistribute"}},
    {"--threshold", {"restart", "redistribute"}},
    {"--importance", {"redistribute"}},
    {"--importance-points", {"redistribute"}},
    {"--object-terms", {"redistribute"}},
    {"--no-log", {"restart", "redistribute"}},
    {"--budget-shots", kByShots},
    {"--budget-ms", {"scratch", "restart", "redistribute", "direct", "hvt", "hvt-peu"}},
    {"--replay", kByShots},
    {"--references", kByShots},
    {"--elements", kByShots},
    {"--save-every", kByShots},
    {"--eps", kByLinks},
    {"--eps1", {"direct", "hvt", "hvt-peu"}},
    {"--min-area", kByLinks},
    {"--link-points", kByLinks},
    {"--b-eps", {"hvt-peu"}}};

class Dynamic {
 public:
  explicit Dynamic(CLI::App& verb) : verb_(verb) {
    verb.add_option("SCENE", path_, "Scene file (.toml) with events")->required();
    verb.add_option(
            "--method", method_,
            "scratch: progressive refinement from nothing after each edit; restart: from the previous solution; "
            "redistribute: radiosity redistribution; of hierarchical links: rebuild, direct, hvt (hierarchical "
            "visibility testing), hvt-peu (and progressive energy update)")
        ->check(CLI::IsMember({"scratch", "restart", "redistribute", "rebuild", "direct", "hvt", "hvt-peu"}))
        ->capture_default_str();
    verb.add_option("--strategy", strategy_, "1: redistribute first, down to the threshold; 2: interleave")
        ->check(CLI::IsMember({"1", "2"}))
        ->capture_default_str();
    verb.add_option("--threshold", options_.threshold, "Of strategy 1, share of the light sources' power")
        ->check(number_between(0, 1))
        ->capture_default_str();
    verb.add_option("--importance", importance_, "How patches are ranked for redistribution")
        ->check(CLI::IsMember({"estimated", "exact"}))
        ->capture_default_str();
    verb.add_option("--importance-points", options_.importance.points, "Points an object of estimated importance")
        ->check(whole_number_between(1, 1000))
        ->capture_default_str();
    verb.add_option("--object-terms", object_terms_,
                    "How patches of the edited object get what is redistributed to them: gathered by each at once, or "
                    "shot by the others, as in Figure 2 of George et al.")
        ->check(CLI::IsMember({"shot", "gathered"}))
        ->capture_default_str();
    links_.add_to(verb);
    links_.add_update_to(verb);
    verb.add_option("--tolerance", options_.tolerance, "When a frame is done: bound of B's error relative to B max")
        ->check(positive_number())
        ->capture_default_str();
    verb.add_option("--budget-shots", budget_shots_, "Most shots a frame after the first; 0: none")
        ->check(whole_number_between(0));
    verb.add_option("--budget-ms", budget_ms_,
                    "Milliseconds of work a frame after the first, by shots beside its edits themselves; 0: none")
        ->check(number_between(0));
    verb.add_option("--replay", replay_, "frames.json of an earlier run whose numbers of shots to repeat");
    verb.add_flag(
        "!--no-log", options_.log,
        "Forget what an edit interrupts: it is never redistributed, and the error that it leaves has no bound");
    verb.add_flag(
        "--work-off", work_off_,
        "After the last event one more frame that works off all that was left; by links, where something was");
    CLI::Option* no_reference =
        verb.add_flag("!--no-reference", reference_, "Leave out the converged references, and with them the errors");
    verb.add_option("--references", reference_file_,
                    "File (.h5) that keeps the converged references, for other runs of the same frames")
        ->excludes(no_reference);
    memory_limit_.add_to(verb);
    CLI::Option* no_images = verb.add_flag("!--no-images", images_, "Leave out pictures and VTP files");
    verb.add_option("--image-size", image_size_, "Width and height of the pictures in pixels")
        ->check(whole_number_between(1, 8192))
        ->excludes(no_images)
        ->capture_default_str();
    patch_size_ = verb.add_option("--patch-size", options_.mesh.patch_size, "Longest edge of a patch [m]")
                      ->check(number_between(0));
    elements_ = verb.add_option("--elements", options_.mesh.elements_per_edge, "Elements along the edge of a patch")
                    ->check(whole_number_between(1, 65'535));
    verb.add_option("--time-limit", time_limit_, "Seconds after which to end with what there is, exit code 4")
        ->check(positive_number());
    verb.add_option(
            "--save-every", save_seconds_,
            "Seconds after which what has been shot is saved in the folder; more where saving takes over 5 % of "
            "the time")
        ->check(number_between(0))
        ->capture_default_str();
    verb.add_option("--threads", threads_, "Threads; as many as there are cores unless given")
        ->check(whole_number_between(1, kMostThreads));
    verb.add_option("-o,--output", folder_, "Folder for frames.json, frame_*.png and frame_*.vtp")->required();
    verb.add_flag("--json", json_, "Print frames.json instead of a summary");
    verb.footer(
        "frames.json is a list: frame 0 is the scene before the first event, each other one follows the events of one\n"
        "time. error and error_worst_1_percent are eq. 7 of George et al. (1990) over elements, against the converged\n"
        "solution of that frame; null where there is no reference. They are relative to the radiosity that the\n"
        "elements should have: where those that change most go dark, as in a new shadow, error_worst_1_percent can\n"
        "exceed 1. error_bound is null while a change is in the log and once --no-log has forgotten one: finished "
        "then\n"
        "says that nothing is left to do, not that B is right; by links, that all links were looked at and their "
        "exchange\n"
        "of energy reached the tolerance. seconds are wall clock, edits included, and so are\n"
        "thread_seconds, summed over threads; cpu_seconds are of the processor. left_undone and\n"
        "left_undone_worst_1_percent of hvt-peu: the same errors if all that links bring which --b-eps left as they "
        "were\n"
        "were missing, but for its further reflection; no reference is needed for them. Where the second is large,\n"
        "as it can be in dark places, a smaller --b-eps is called for.\n"
        "Each frame is written when it is done; Ctrl-C ends with those so far, exit code 4. By shots the same command\n"
        "goes on from there, and after a crash from what was saved last; another one begins anew.\n"
        "Methods by links link all pairs of patches: clusters of patches are for solve --method hierarchical.");
  }

  void run() {
    start_ = Clock::now();
    const std::size_t threads =
        threads_ ? *threads_ : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    catch_interrupts();
    refuse_what_is_not_used();
    if (budget_shots_.has_value() + budget_ms_.has_value() + !replay_.empty() > 1)
      throw CLI::ValidationError("--budget-shots, --budget-ms, --replay", "only one of them can be given");
    const DynamicScene given = read_dynamic_scene(path_, Emission::exitance);
    for (const std::string& warning : given.scene.warnings) print_warning(warning);
    if (given.events.empty()) print_warning(fmt::format("{}: has no [[event]]; there is one frame", path_));
    const std::vector<std::uint64_t> replayed = shots_to_replay();
    results_.emplace(folder_);
    if (const auto by_links = link_method_named(method_)) {
      LinkFrameOptions how;
      how.links =
          links_.chosen(given, patch_size_->count() > 0 ? std::optional(options_.mesh.patch_size) : std::nullopt);
      how.links.tolerance = options_.tolerance;
      how.links.mesh.memory_limit = memory_limit_.bytes();
      how.method = *by_links;
      how.abandon = interrupted;
      set_frames(how);
      Checkpoint of_shots(unfinished(), "work links\n", Checkpoint::OtherRun::forgotten);
      if (of_shots.has_forgotten()) print_warning(of_shots.what_was_forgotten());
      partial_ = follow_links(given, how, results_->draft()) == LinksEnd::unfinished || partial_;
      return finish();
    }
    set_options(given.scene);
    ShotFrameOptions how;
    how.session = options_;
    how.method = method_;
    how.budget_shots = budget_shots_;
    how.replayed = replayed;
    how.kept_references = reference_file_;
    how.memory = memory_limit_.bytes();
    how.checkpoint = unfinished();
    how.key = key_of(given) + fmt::format("shots {}\n", fmt::join(replayed, " "));
    how.save_seconds = save_seconds_;
    set_frames(how);
    ShotFrames frames = follow_shots(given, how, results_->draft());
    frames_ = std::move(frames.list);
    partial_ = !frames.finished;
    finish();
  }

 private:
  /// What a method would not look at is refused.
  void refuse_what_is_not_used() const {
    for (const auto& [option, methods] : kMethodsOfOptions) {
      if (verb_.get_option(option)->count() == 0 || std::ranges::count(methods, method_) > 0) continue;
      throw CLI::ValidationError(option, fmt::format("needs --method {}", fmt::join(methods, ", ")));
    }
    if (verb_.get_option("--importance-points")->count() > 0 && importance_ != "estimated")
      throw CLI::ValidationError("--importance-points", "needs --importance estimated");
  }

  void set_frames(FrameOptions& how) {
    how.path = path_;
    if (budget_ms_) how.budget = *budget_ms_ / 1000;
    how.work_off = work_off_;
    how.references = reference_;
    how.images = images_;
    how.image_size = image_size_;
    how.stop = [this] { return stop(); };
    how.finished = [this](const FrameList& so_far) { keep_frames(so_far); };
  }

  /// Whatever happens later, the frames so far are there: first their files, then the list that names them.
  void keep_frames(const FrameList& so_far) {
    frames_ = so_far;
    results_->publish();
    write_whole_file(results_->draft() / "frames.json",
                     [&](std::ostream& out) { out << frames_.frames.dump(1) << '\n'; });
    results_->publish();
  }

  std::string unfinished() const { return (std::filesystem::path(folder_) / ResultFolder::kUnfinished).string(); }

  /// All that frames show and tell depends on.
  std::string key_of(const DynamicScene& given) const {
    std::string key = key_of_run(verb_, kOfNoConsequence, given.scene, options_.mesh);
    const auto add_camera = [&](double time, const Camera& camera) {
      key += fmt::format("camera {} {}", time, camera.vertical_fov_degrees);
      for (const Vec3& at : {camera.eye, camera.target, camera.up}) key += fmt::format(" {} {} {}", at.x, at.y, at.z);
      key += '\n';
    };
    if (given.scene.camera) add_camera(0, *given.scene.camera);
    for (const CameraAt& at : given.camera_path) add_camera(at.time, at.camera);
    EditedScene scene(given.scene);
    for (const Event& event : given.events) {
      scene.apply(event.edit);
      key += fmt::format("event {} {} {} {} {}\n", event.time, name_of(event.edit.operation), event.edit.object,
                         scene_hash(scene.scene()), given.scene.objects[event.edit.object].name);
    }
    return key;
  }

  void finish() {
    const std::size_t count = frames_.frames.size();
    print_results(json_ ? frames_.frames.dump(1) + '\n' : printable(frames_.summary));
    if (partial_) {
      print_message(count == 0 ? "stopped before the first frame was done; nothing was saved"
                               : fmt::format("stopped after {} frame{}; the partial result was saved{}", count,
                                             count == 1 ? "" : "s",
                                             link_method_named(method_) ? "" : ", and the same command goes on"));
      throw CLI::RuntimeError(limit_reached);
    }
  }

  bool stop() {
    if (interrupted() || (time_limit_ && seconds_since(start_) > *time_limit_)) partial_ = true;
    return partial_;
  }

  void set_options(const Scene& scene) {
    static const std::map<std::string, UpdateMethod> kMethods = {{"scratch", UpdateMethod::scratch},
                                                                 {"restart", UpdateMethod::restart},
                                                                 {"redistribute", UpdateMethod::redistribute}};
    options_.method = kMethods.at(method_);
    options_.strategy = strategy_ == "1" ? Strategy::redistribute_first : Strategy::interleave;
    options_.importance.kind =
        importance_ == "exact" ? ImportanceOptions::Kind::exact : ImportanceOptions::Kind::estimated;
    options_.object_terms = object_terms_ == "gathered" ? ObjectTerms::gathered : ObjectTerms::shot;
    if (patch_size_->count() == 0) options_.mesh.patch_size = scene.mesh.patch_size;
    if (elements_->count() == 0) {
      options_.mesh.elements_per_edge = scene.mesh.elements_per_edge;
      options_.mesh.small_patch = scene.mesh.small_patch;
    }
    options_.mesh.memory_limit = memory_limit_.bytes();
  }

  /// By frame; none where none is to be repeated.
  std::vector<std::uint64_t> shots_to_replay() const {
    if (replay_.empty()) return {};
    const nlohmann::json frames = read_json(replay_);
    if (!frames.is_array()) throw InputError(replay_, 0, "is no list of frames; name a frames.json");
    std::vector<std::uint64_t> shots;
    for (const auto& frame : frames) {
      if (!frame.is_object() || !frame.contains("shots") || !frame["shots"].is_number_unsigned())
        throw InputError(replay_, 0, "a frame has no number of \"shots\"; name a frames.json");
      shots.push_back(frame["shots"].get<std::uint64_t>());
    }
    return shots;
  }

  CLI::App& verb_;
  SessionOptions options_;
  LinkSettings links_;
  CLI::Option *patch_size_ = nullptr, *elements_ = nullptr;
  std::string path_, method_ = "redistribute", strategy_ = "1", importance_ = "estimated", object_terms_ = "gathered",
                     replay_, reference_file_, folder_;
  MemoryLimit memory_limit_;
  std::uint32_t image_size_ = 800;
  std::optional<std::uint64_t> budget_shots_;
  std::optional<double> budget_ms_, time_limit_;
  std::optional<std::size_t> threads_;
  double save_seconds_ = 30;
  bool work_off_ = false, reference_ = true, images_ = true, json_ = false;

  Clock::time_point start_;
  std::optional<ResultFolder> results_;
  FrameList frames_;
  std::atomic<bool> partial_ = false;  // links ask to stop from all threads
};

}  // namespace

void add_dynamic(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("dynamic", "Follow the radiosity of a scene through its events");
  verb->callback([dynamic = std::make_shared<Dynamic>(*verb)] { dynamic->run(); });
}

}  // namespace exitance
