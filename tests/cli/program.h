#pragma once
// Runs the built program as a user would.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/output/scratch_folder.h"
#include "tests/places.h"

namespace exitance {

struct Outcome {
  int code = -1;  ///< exit code; −1 when a signal ended the program
  std::string out, err;

  bool one_line_on_stderr() const {
    return std::ranges::count(err, '\n') == 1 && err.back() == '\n' && err.starts_with("exitance: ");
  }
};

/// before: what stands before the program on the command line.
inline Outcome run(const std::string& arguments, const std::string& before = "") {
  const ScratchFolder scratch;
  const std::string out = (scratch / "out").string(), err = (scratch / "err").string();
  const int status =
      std::system((before + " " + program() + " " + arguments + " >" + out + " 2>" + err + " </dev/null").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out), contents(err)};
}

/// Has it run for so many seconds at most, kills it, and waits until it is dead (which `timeout` would do only in the
/// foreground: else the signal that it sends ends itself, too).
inline void run_and_kill(const std::string& arguments, double seconds) {
  run(arguments, "timeout --foreground -s KILL " + std::to_string(seconds));
}

inline std::string data(const std::string& name) {
  return source_file("data/" + name);
}

inline nlohmann::json json_in(const std::filesystem::path& file) {
  return nlohmann::json::parse(contents(file));
}

}  // namespace exitance
