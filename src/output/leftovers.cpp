#include "src/output/leftovers.h"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

namespace exitance {
namespace {

namespace fs = std::filesystem;

std::string name_of_this_system() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  struct stat processes {};
  if (stat("/proc/self/ns/pid", &processes) != 0) processes.st_ino = 0;
  return std::string(host.data()) + "-" + std::to_string(processes.st_ino) + "-";
}

/// Whether it runs: one that was killed keeps its number until its parent has taken notice.
bool is_alive(pid_t process) {
  if (kill(process, 0) != 0 && errno == ESRCH) return false;
  std::ifstream status("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(status, text);
  const std::size_t name_end = text.rfind(") ");
  return name_end == std::string::npos || (text[name_end + 2] != 'Z' && text[name_end + 2] != 'X');
}

/// Whether the name is that of a process which is no more.
bool is_of_the_dead(std::string_view name, std::string_view before, std::string_view after) {
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) return false;
  name.remove_prefix(before.size());
  name.remove_suffix(after.size());
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  return error == std::errc() && end == name.data() + name.size() && process > 0 && !is_alive(process);
}

}  // namespace

std::string name_of_process(pid_t process) {
  return name_of_this_system() + std::to_string(process);
}

void remove_leftovers(const fs::path& folder, std::string_view before, std::string_view after) {
  const std::string begin = std::string(before) + name_of_this_system();
  std::error_code failed;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    if (is_of_the_dead(entry->path().filename().native(), begin, after)) found.push_back(entry->path());
  }
  for (const fs::path& path : found) fs::remove_all(path, failed);
}

}  // namespace exitance
