#include "src/cli/shot_frames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/cli/console.h"
#include "src/cli/progress_display.h"
#include "src/cli/reference_store.h"
#include "src/cli/stations.h"
#include "src/dynamic/converged_reference.h"
#include "src/dynamic/picture.h"
#include "src/output/checkpoint.h"
#include "src/output/run_clock.h"
#include "src/output/save_pace.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

void write_work(ArchiveWriter& file, const SessionWork& work) {
  std::vector<std::uint64_t> counts{work.propagations, work.redistributions, work.gatherings};
  for (const ChangeWork& of : {work.propagation, work.redistribution, work.gathering})
    counts.insert(counts.end(), {of.candidates, of.kept, of.visibility_tests, of.idle_tests, of.idle_patch_tests});
  file.write("work", std::span<const std::uint64_t>(counts));
  file.write("work_seconds", std::span(&work.seconds, 1));
}

SessionWork read_work(const ArchiveReader& file) {
  const std::vector<std::uint64_t> n = file.uint64s("work");
  const std::vector<double> seconds = file.doubles("work_seconds");
  if (n.size() != 18 || seconds.size() != 1) file.refuse("it does not tell what was done");
  SessionWork work;
  work.propagations = n[0];
  work.redistributions = n[1];
  work.gatherings = n[2];
  work.seconds = seconds[0];
  std::size_t at = 3;
  for (ChangeWork* of : {&work.propagation, &work.redistribution, &work.gathering}) {
    *of = {n[at], n[at + 1], n[at + 2], n[at + 3], n[at + 4]};
    at += 5;
  }
  return work;
}

class Frames {
 public:
  Frames(const DynamicScene& given, const ShotFrameOptions& options, const std::filesystem::path& folder)
      : given_(given),
        options_(options),
        folder_(folder),
        stations_(stations_of(given.events)),
        store_(options.references ? options.kept_references : ""),
        checkpoint_(options.checkpoint, options.key, Checkpoint::OtherRun::forgotten),
        pace_(options.save_seconds) {
    if (options.work_off) stations_.push_back(working_off(stations_.back()));
    if (checkpoint_.has_forgotten()) print_warning(checkpoint_.what_was_forgotten());
  }

  /// Whether all frames are done.
  bool follow() {
    if (!checkpoint_.read_last([this](const ArchiveReader& file) { read(file); })) begin();
    while (result_.frames.size() < stations_.size()) {
      if (result_.frames.size() > 0 && stop()) {
        keep();
        return false;
      }
      const Station& station = stations_[result_.frames.size()];
      if (!has_begun_) {
        for (std::size_t k = station.first; k < station.last; ++k) apply(given_.events[k]);
        has_begun_ = true;
      }
      frame(station);
      if (stopped_) return false;
    }
    checkpoint_.remove();
    return true;
  }
  const FrameList& result() const { return result_; }

 private:
  bool stop() { return stopped_ = stopped_ || (options_.stop && options_.stop()); }

  void begin() {
    session_.emplace(given_.scene, options_.session);
    if (options_.references) references_.emplace(given_.scene, options_.session, session_->solution(), options_.memory);
  }

  void read(const ArchiveReader& file) {
    const std::vector<std::uint8_t> has_begun = file.uint8s("has_begun");
    Json frames = Json::parse(file.text("frames"), nullptr, false);
    if (has_begun.size() != 1 || !frames.is_array() || frames.size() > stations_.size() ||
        (has_begun[0] != 0 && frames.size() == stations_.size()))
      file.refuse("it is of other frames");
    const std::size_t events = has_begun[0] != 0 ? stations_[frames.size()].last
                               : frames.empty()  ? 0
                                                 : stations_[frames.size() - 1].last;
    std::vector<Edit> edits;
    for (std::size_t k = 0; k < events; ++k) edits.push_back(given_.events[k].edit);
    const std::vector<double> seconds = file.doubles("edit_seconds");
    if (seconds.size() != 1) file.refuse("it does not tell how long edits took");
    const SessionWork work = read_work(file);
    std::vector<double> reference_before = file.doubles("reference_before");
    std::string summary = file.text("summary");
    EditSession session = EditSession::taken_up(given_.scene, options_.session, edits, file, "session_");
    std::optional<FrameReferences> references;
    if (options_.references)
      references.emplace(FrameReferences::taken_up(given_.scene, options_.session, edits, file, "references_"));

    // All of it can be read.
    has_begun_ = has_begun[0] != 0;
    edit_seconds_ = seconds[0];
    work_ = work;
    reference_before_ = std::move(reference_before);
    result_ = {std::move(frames), std::move(summary)};
    session_.emplace(std::move(session));
    references_ = std::move(references);
  }

  void keep() {
    checkpoint_.replace([&](ArchiveWriter& file) {
      const std::uint8_t has_begun = has_begun_;
      file.write("has_begun", std::span(&has_begun, 1));
      file.write("frames", result_.frames.dump());
      file.write("summary", result_.summary);
      file.write("edit_seconds", std::span(&edit_seconds_, 1));
      write_work(file, work_);
      file.write("reference_before", std::span<const double>(reference_before_));
      session_->write(file, "session_");
      if (references_) references_->write(file, "references_");
    });
  }

  void apply(const Event& event) {
    const RunClock clock;
    try {
      session_->apply(event.edit);
    } catch (const InvalidEdit& wrong) {
      throw InputError(options_.path, event.line, wrong.what());
    }
    edit_seconds_ += clock.seconds();
    if (references_) references_->apply(event.edit);
  }

  Budget budget(const Station& station) {
    Budget budget;
    budget.interrupted = [this] { return stop(); };
    budget.after_shot = [this](const SessionWork& work) {
      work_ = work;
      pace_.in_time([this] { keep(); });
      show_progress();
    };
    const std::size_t number = result_.frames.size();
    if (!options_.replayed.empty()) budget.shots = number < options_.replayed.size() ? options_.replayed[number] : 0;
    if (number == 0 || station.works_off) return budget;
    if (options_.budget_shots) budget.shots = options_.budget_shots;
    budget.seconds = options_.budget;
    return budget;
  }

  /// By the decades that lie between all light and the tolerance.
  void show_progress() {
    if (since_shown_.seconds() < 0.1) return;
    since_shown_ = RunClock();
    const double tolerance = std::min(options_.session.tolerance, 0.5);
    const double left = session_->propagation_left() / session_->solution().power_of_sources();
    shown_ = std::clamp(std::log(std::max(tolerance, left)) / std::log(tolerance), shown_, 1.0);
    display_.show(shown_, fmt::format("frame {} of {}", result_.frames.size(), stations_.size() - 1));
  }

  void frame(const Station& station) {
    shown_ = 0;
    work_ = session_->work(budget(station), work_);
    const double seconds = edit_seconds_ + work_.seconds;
    const DynamicRadiosity& state = session_->solution();
    display_.clear();
    // Only now is an object that is selected where it is shown.
    warn_of_trespass(options_.path, lines_of_edits(given_, station), session_->scene(), state.version().soup(),
                     state.version().facet_ranges());
    const std::vector<double> B = state.element_B();
    std::optional<ConvergenceError> error;
    std::optional<std::vector<double>> reference;
    if (references_ && !stopped_) {
      // Of the first frame nothing came before: what changed most is what is brightest.
      reference = store_.find(*session_, *references_, [this] { return stop(); });
      if (reference) error = convergence_error(state.version(), state.bands(), *reference, reference_before_, B);
    }
    const std::vector<std::string> edits = names_of_edits(given_, station);
    Json frame = record(station, edits, error);
    const std::string line = fmt::format("frame {:3}  {:>9.3f} s  {:5} + {:5} shots  {}  {}\n", result_.frames.size(),
                                         seconds, work_.redistributions + work_.gatherings, work_.propagations,
                                         in_words(error), fmt::format("{}", fmt::join(edits, ", ")));
    if (options_.images) draw(station.time, B);
    if (stopped_) keep();  // without the frame, which is not done
    result_.frames.push_back(std::move(frame));
    result_.summary += line;
    options_.finished(result_);
    store_.save();
    if (stopped_) return;
    if (reference) reference_before_ = std::move(*reference);
    has_begun_ = false;
    work_ = {};
    edit_seconds_ = 0;
  }

  Json record(const Station& station, const std::vector<std::string>& edits,
              const std::optional<ConvergenceError>& error) {
    const DynamicRadiosity& state = session_->solution();
    Json frame;
    frame["frame"] = result_.frames.size();
    frame["time"] = station.time;
    frame["edits"] = edits;
    frame["method"] = options_.method;
    frame["seconds"] = edit_seconds_ + work_.seconds;
    frame["seconds_edits"] = edit_seconds_;
    frame["shots"] = work_.shots();
    frame["propagation_shots"] = work_.propagations;
    frame["redistribution_shots"] = work_.redistributions;
    frame["gathered_patches"] = work_.gatherings;
    frame["visibility_tests"] =
        work_.propagation.visibility_tests + work_.redistribution.visibility_tests + work_.gathering.visibility_tests;
    frame["redistribution_tests"] = work_.redistribution.visibility_tests;
    frame["redistribution_tests_idle"] = work_.redistribution.idle_tests;
    frame["redistribution_tests_idle_patches"] = work_.redistribution.idle_patch_tests;
    frame["elements_kept_in_umbra"] = work_.redistribution.kept;
    frame["error"] = error ? Json(error->all) : Json(nullptr);
    frame["error_worst_1_percent"] = error ? Json(error->worst_1_percent) : Json(nullptr);
    frame["reference"] = error ? Json(references_->gathers() ? "gathering" : "shots") : Json(nullptr);
    const bool is_bounded = state.pending_changes() == 0 && !state.has_forgotten();
    frame["error_bound"] = is_bounded ? Json(state.error_bound()) : Json(nullptr);
    frame["finished"] = work_.finished;
    frame["propagation_left"] = session_->propagation_left();
    Json log = Json::array();
    double left = 0;
    for (const PendingChange& change : session_->log()) {
      log.push_back({{"change", change.name},
                     {"patches", change.patches},
                     {"patch", change.patch},
                     {"energy", change.largest_energy}});
      left = std::max(left, change.largest_energy);
    }
    frame["redistribution_left"] = left;
    frame["log"] = log;
    frame["patches"] = state.version().present_patches();
    frame["elements"] = state.version().present_elements();
    frame["unit"] = given_.scene.unit;
    return frame;
  }

  void draw(double time, const std::vector<double>& B) const {
    const DynamicRadiosity& state = session_->solution();
    const Faces faces = faces_of(state.version());
    write_frame(folder_, given_, {result_.frames.size(), time, faces, state.bands(), B}, [&](const Camera& camera) {
      return picture(state, B, camera, {options_.image_size, options_.image_size});
    });
  }

  const DynamicScene& given_;
  const ShotFrameOptions& options_;
  std::filesystem::path folder_;
  std::vector<Station> stations_;  // of the frames
  ReferenceStore store_;
  Checkpoint checkpoint_;
  SavePace pace_;
  ProgressDisplay display_;
  RunClock since_shown_;
  double shown_ = 0;

  FrameList result_;
  std::optional<EditSession> session_;
  std::optional<FrameReferences> references_;
  std::vector<double> reference_before_;
  // Of the frame in hand:
  bool has_begun_ = false;   // its edits were made
  SessionWork work_;         // so far
  double edit_seconds_ = 0;  // of its edits
  bool stopped_ = false;
};

}  // namespace

ShotFrames follow_shots(const DynamicScene& given, const ShotFrameOptions& options,
                        const std::filesystem::path& folder) {
  Frames frames(given, options, folder);
  const bool finished = frames.follow();
  return {frames.result(), finished};
}

}  // namespace exitance
