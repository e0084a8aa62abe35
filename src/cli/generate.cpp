// exitance generate: scenes made by rules.

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>

#include "src/cli/console.h"
#include "src/cli/number_range.h"
#include "src/cli/verbs.h"
#include "src/output/obj.h"
#include "src/scene/furnished_room.h"

namespace exitance {
namespace {

class GenerateFurnishedRoom {
 public:
  explicit GenerateFurnishedRoom(CLI::App& verb) {
    verb.add_option("--polygons", polygons_, "How many polygons the room has, furniture included")
        ->required()
        ->check(whole_number_between(100, 1'000'000));
    verb.add_option("--seed", seed_, "Other numbers give other rooms")
        ->check(whole_number_between(0))
        ->capture_default_str();
    verb.add_option("-o,--output", file_, "OBJ file to write; its materials stand beside it in .mtl")->required();
  }

  void run() const {
    write_obj(make_furnished_room(polygons_, seed_), file_);
    print_results(printable(fmt::format("{}: a furnished room of {} polygons, seed {}\n", file_, polygons_, seed_)));
  }

 private:
  std::uint32_t polygons_ = 0;
  std::uint64_t seed_ = 1;
  std::string file_;
};

}  // namespace

void add_generate(CLI::App& app) {
  CLI::App* generate = app.add_subcommand("generate", "Make a scene by rules");
  generate->require_subcommand(1);
  CLI::App* room = generate->add_subcommand("furnished-room", "A closed room of any size with furniture that touches");
  room->callback([verb = std::make_shared<const GenerateFurnishedRoom>(*room)] { verb->run(); });
}

}  // namespace exitance
