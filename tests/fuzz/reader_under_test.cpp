#include "tests/fuzz/reader_under_test.h"

#include <array>
#include <filesystem>
#include <fstream>

#include "src/cli/case_answers.h"
#include "src/cli/case_reader.h"
#include "src/cli/json_text.h"
#include "src/reference/matrix_file.h"
#include "src/reference/solution_record.h"
#include "src/scene/input_error.h"
#include "src/scene/reader.h"
#include "src/scene/scene_check.h"
#include "src/scene/scene_file.h"
#include "tests/places.h"

namespace exitance {
namespace {

/// As `solve` and as `check` read it.
void scene(const std::string& path) {
  try {
    read_scene(path);
  } catch (const InputError&) {
  }
  read_scene(path, {.flip = true, .two_sided = true, .keep_faults = true});
}

void bare_scene(const std::string& path) {
  try {
    read_scene(path);
  } catch (const InputError&) {
  }
  read_scene(path, {.keep_faults = true});
}

void events(const std::string& path) {
  bare_scene(path);
  read_dynamic_scene(path, Emission::exitance);
}

/// The mesh beside it is sound.
void materials(const std::string& path) {
  read_scene(std::filesystem::path(path).replace_extension(".obj"));
}

void cases(const std::string& path) {
  const nlohmann::json given = read_json(path);
  if (!given.is_object() || !given.contains("cases") || !given["cases"].is_array()) return;
  for (const auto& one : given["cases"]) {
    try {
      answer_to(one, 1e-6);
    } catch (const InvalidCase&) {
    }
  }
}

void matrix(const std::string& path) {
  read_matrix(path);
}

/// As an archive, or a file of `solve` with its report beside it.
void solution(const std::string& path) {
  read_solution(path);
}

}  // namespace

/// The leak sanitizer asks this. libhdf5 1.10 loses what it has read of a damaged object header.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

std::span<const ReaderUnderTest> readers_under_test() {
  static const std::array kReaders{ReaderUnderTest{"obj", {"room.obj", "libraries.obj"}, "a.obj", scene},
                                   ReaderUnderTest{"mtl", {"room.mtl"}, "room.mtl", materials},
                                   ReaderUnderTest{"ply", {"quad.ply", "binary.ply"}, "a.ply", scene},
                                   ReaderUnderTest{"off", {"tetrahedron.off"}, "a.off", scene},
                                   ReaderUnderTest{"stl", {"triangle.stl", "binary.stl"}, "a.stl", scene},
                                   ReaderUnderTest{"vs3", {"room.vs3"}, "a.vs3", bare_scene},
                                   ReaderUnderTest{"toml", {"scene.toml"}, "a.toml", events},
                                   ReaderUnderTest{"cases", {"questions.json"}, "a.json", cases},
                                   ReaderUnderTest{"matrix_h5", {"matrix.h5"}, "a.h5", matrix},
                                   ReaderUnderTest{"solution_h5", {"solution.h5"}, "a.h5", solution},
                                   ReaderUnderTest{"solution_vtp", {"solution.vtp"}, "solution.vtp", solution},
                                   ReaderUnderTest{"matrix_csv", {"matrix.csv"}, "a.csv", matrix},
                                   ReaderUnderTest{"matrix_txt", {"matrix.txt"}, "a.txt", matrix}};
  return kReaders;
}

std::string seed_path(const std::string& name) {
  return source_file("tests/fuzz/seeds/" + name);
}

void copy_companions(const std::string& folder) {
  for (const char* name : {"room.obj", "room.mtl", "result.json"})
    std::filesystem::copy(seed_path(name), folder + "/" + name);
}

void read_bytes(const ReaderUnderTest& reader, const std::string& folder, const std::string& bytes) {
  const std::string path = folder + "/" + reader.file;
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  try {
    reader.read(path);
  } catch (const InputError&) {
  } catch (const LimitError&) {
  }
}

}  // namespace exitance
