#pragma once
// The built program in the background, to be ended while it works.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "tests/places.h"

namespace exitance {

/// How many files of a folder have the extension; 0 where there is no folder.
inline std::size_t files_with(const std::string& extension, const std::filesystem::path& folder) {
  std::error_code failed;
  std::size_t count = 0;
  for (std::filesystem::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed))
    count += entry->path().extension() == extension;
  return count;
}

class Running {
 public:
  /// messages: a file for what it tells on stderr.
  explicit Running(const std::string& arguments, const std::string& messages = "/dev/null") : child_(fork()) {
    if (child_ != 0) return;
    const std::string command = "exec " + program() + " " + arguments + " >/dev/null 2>" + messages + " </dev/null";
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }

  /// Sends a signal as soon as the condition holds, and returns the exit code, −1 if the signal ended it. That it ends
  /// before is a failure.
  int end_when(const std::function<bool()>& condition, int signal) const {
    int status = 0;
    while (!condition()) {
      if (waitpid(child_, &status, WNOHANG) == child_) {
        ADD_FAILURE() << "ended by itself";
        return 0;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    kill(child_, signal);
    waitpid(child_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t child_;
};

}  // namespace exitance
