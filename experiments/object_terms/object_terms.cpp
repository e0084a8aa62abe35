// What an edited object receives can be shot to it or gathered by it: which is sooner right, and which answers sooner?

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/goal.h"
#include "src/dynamic/converged_reference.h"
#include "src/dynamic/edit_session.h"
#include "src/output/run_clock.h"
#include "src/scene/furnished_room.h"
#include "src/scene/scene_file.h"
#include "tests/places.h"

namespace exitance {
namespace {

/// [s] of the processor.
constexpr std::array kBudgets{0.005, 0.05, 0.5};

struct Case {
  std::string scene, edit;
  std::vector<Edit> first;  ///< worked off before
  Edit then;
};

struct Place {
  Scene scene;
  MeshOptions mesh;
  std::vector<Case> cases;
};

std::uint32_t object_named(const Scene& scene, const std::string& name) {
  const auto found = std::ranges::find(scene.objects, name, &SceneObject::name);
  return static_cast<std::uint32_t>(found - scene.objects.begin());
}

Edit put(Operation operation, std::uint32_t object, const Placement& placement) {
  return {operation, object, placement, {}, {}};
}

Placement by(const Vec3& translation) {
  Placement placement;
  placement.translation = translation;
  return placement;
}

Place cube_room(bool reduced) {
  const DynamicScene file = read_dynamic_scene(source_file("data/cube.toml"), Emission::exitance);
  Place place{
      file.scene, {file.scene.mesh.patch_size, file.scene.mesh.elements_per_edge, file.scene.mesh.small_patch}, {}};
  if (reduced) place.mesh = {1.0, 1};
  const std::uint32_t cube = object_named(file.scene, "cube"), table = object_named(file.scene, "table top");
  const Edit comes{Operation::add, cube, {}, {}, {}};
  place.cases.push_back({"Cube", "the cube comes", {}, comes});
  place.cases.push_back({"Cube", "it moves by 2 cm", {comes}, put(Operation::move, cube, by({0.02, 0, 0}))});
  place.cases.push_back({"Cube", "it moves by 40 cm", {comes}, put(Operation::move, cube, by({0.4, 0, 0}))});
  place.cases.push_back({"Cube", "it goes", {comes}, {Operation::remove, cube, {}, {}, {}}});
  Placement large{scaling({3, 3, 4}), {}};  // 1.2 m by 1.2 m by 1.6 m, on the floor before the table
  large.translation = Vec3{0.2, 0.3, 0} - large(Vec3{2.1, 1.5, 0.75});
  place.cases.push_back({"Cube", "a large box comes", {}, put(Operation::add, cube, large)});
  place.cases.push_back({"Cube", "the table top goes", {}, {Operation::remove, table, {}, {}, {}}});
  return place;
}

Place furnished(bool reduced) {
  const DynamicScene file = read_dynamic_scene(source_file("data/robot.toml"), Emission::exitance);
  const std::uint32_t polygons = reduced ? 100 : 1000;
  Place place{make_furnished_room(polygons, 7), {}, {}};
  Scene& scene = place.scene;
  const auto material = static_cast<std::uint32_t>(scene.materials.size());
  scene.materials.insert(scene.materials.end(), file.scene.materials.begin(), file.scene.materials.end());
  const std::uint32_t robot = object_named(file.scene, "robot");
  const auto here = static_cast<std::uint32_t>(scene.objects.size());
  scene.objects.push_back(file.scene.objects[robot]);
  for (Surface surface : file.scene.absent) {
    if (surface.object != robot) continue;
    surface.object = here;
    surface.material += material;
    scene.absent.push_back(std::move(surface));
  }
  const Edit comes = put(Operation::add, here, by({1.3, 1.55, 0}));
  const std::string name = fmt::format("room of {}", polygons);
  place.cases.push_back({name, "a robot comes", {}, comes});
  if (reduced) return place;
  place.cases.push_back({name, "it moves by 5 cm", {comes}, put(Operation::move, here, by({1.35, 1.55, 0}))});
  place.cases.push_back({name, "it goes", {comes}, {Operation::remove, here, {}, {}, {}}});
  return place;
}

class Followed {
 public:
  Followed(const Place& place, double tolerance, CsvTable& table) : table_(table) {
    options_.mesh = place.mesh;
    options_.tolerance = tolerance;
    before_.emplace(place.scene, options_);
    before_->work({});
  }

  void follow(const Case& edited) {
    EditSession start(*before_, options_);
    for (const Edit& edit : edited.first) start.apply(edit);
    start.work({});
    const std::vector<double> was = start.solution().element_B();
    EditSession end(start, options_);
    end.apply(edited.then);
    reference_ = converged_reference(end.solution());
    for (const ObjectTerms terms : {ObjectTerms::shot, ObjectTerms::gathered}) {
      SessionOptions options = options_;
      options.object_terms = terms;
      run(edited, terms == ObjectTerms::shot ? "shot" : "gathered", EditSession(start, options), was);
    }
  }

 private:
  void run(const Case& edited, const std::string& terms, EditSession session, const std::vector<double>& was) {
    std::vector<std::uint32_t> stood;
    for (std::uint32_t e = 0; e < session.solution().version().elements(); ++e) {
      if (session.solution().version().has_element(e)) stood.push_back(e);
    }
    RunClock clock;
    session.apply(edited.then);
    double seconds = clock.cpu_seconds(), longest = seconds;
    std::vector<double> at_budget(kBudgets.size(), 1);
    const SceneVersion& version = session.solution().version();
    std::erase_if(stood, [&](std::uint32_t e) {
      return !version.has_element(e) || version.object_of_element(e) == edited.then.object;
    });
    const std::uint32_t bands = session.solution().bands();
    const std::vector<std::uint32_t> shadows = most_changed(stood, bands, reference_, was);
    const auto area = [&](std::uint32_t e) { return version.mesh().elements[e].area; };
    GoalReached all, room;
    std::uint64_t shots = 0, tests = 0, idle = 0;
    Budget one;
    one.shots = 1;
    for (bool finished = false; !finished;) {
      const std::vector<double> B = session.solution().element_B();
      const double error = convergence_error(version, bands, reference_, was, B).worst_1_percent;
      all.record(error, shots, seconds);
      room.record(convergence_error(shadows, area, bands, reference_, was, B).all, shots, seconds);
      for (std::size_t k = 0; k < kBudgets.size(); ++k) {
        if (seconds <= kBudgets[k]) at_budget[k] = error;
      }
      clock = RunClock();
      const SessionWork work = session.work(one);
      const double took = clock.cpu_seconds();
      seconds += took;
      longest = std::max(longest, took);
      shots += work.shots();
      tests += work.redistribution.visibility_tests;
      idle += work.redistribution.idle_patch_tests;
      finished = work.finished;
    }
    std::vector<std::string> row{edited.scene,
                                 edited.edit,
                                 terms,
                                 all.shots(),
                                 room.shots(),
                                 fmt::format("{}", shots),
                                 digits(tests > 0 ? static_cast<double>(idle) / static_cast<double>(tests) : 0),
                                 all.seconds(),
                                 room.seconds(),
                                 fmt::format("{:.3g}", seconds)};
    for (const double error : at_budget) row.push_back(fmt::format("{:.3g}", error));
    row.push_back(fmt::format("{:.3g}", 1e3 * longest));
    fmt::print(stderr, "{}\n", fmt::join(row, ", "));
    table_.rows.push_back(std::move(row));
  }

  CsvTable& table_;
  SessionOptions options_;
  std::optional<EditSession> before_;
  std::vector<double> reference_;
};

int run(int argc, char** argv) {
  CLI::App app{"What an edited object receives: shot to it or gathered by it"};
  ExperimentOptions wanted(app, "the table", "Coarse meshes", "Compare with this table; exit code 1 where it differs");
  CLI11_PARSE(app, argc, argv);
  CsvTable table{
      {"scene", "edit", "object_terms", "shots_to_5_percent", "shots_to_5_percent_of_room", "shots", "idle_share",
       "cpu_seconds_to_5_percent", "cpu_seconds_to_5_percent_of_room", "cpu_seconds_to_the_end", "error_after_5_ms",
       "error_after_50_ms", "error_after_500_ms", "longest_shot_ms"},
      {}};
  for (const Place& place : {cube_room(wanted.reduced()), furnished(wanted.reduced())}) {
    Followed followed(place, wanted.reduced() ? 1e-3 : 1e-6, table);
    for (const Case& edited : place.cases) followed.follow(edited);
  }
  if (wanted.writes()) table.write(wanted.folder() / "summary.csv");
  return wanted.check(table, 3, 0.02,
                      {"cpu_seconds_to_5_percent", "cpu_seconds_to_5_percent_of_room", "cpu_seconds_to_the_end",
                       "error_after_5_ms", "error_after_50_ms", "error_after_500_ms", "longest_shot_ms"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
