#include "src/output/result_folder.h"

#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "src/output/leftovers.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace fs = std::filesystem;
namespace {

constexpr const char* kDraft = ".draft.";

}  // namespace

ResultFolder::ResultFolder(fs::path folder)
    : folder_(std::move(folder)), draft_(folder_ / (kDraft + name_of_process(getpid()))) {
  remove_leftovers(folder_, kDraft, "");
  std::error_code failed, ignored;
  const fs::path whole = fs::absolute(folder_, failed);
  for (fs::path path = whole; path.has_relative_path() && !fs::exists(path, ignored); path = path.parent_path())
    made_.push_back(path);
  if (!failed) fs::create_directories(draft_, failed);
  if (failed) {
    remove_draft();
    throw InputError(folder_.string(), 0,
                     "results cannot be written there (" + failed.message() + "); choose a folder that is writable");
  }
}

ResultFolder::~ResultFolder() {
  remove_draft();
}

void ResultFolder::remove_draft() const {
  std::error_code ignored;
  fs::remove_all(draft_, ignored);
  for (const fs::path& folder : made_) fs::remove(folder, ignored);
}

void ResultFolder::publish() const {
  std::error_code failed;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(draft_, failed), end; !failed && entry != end; entry.increment(failed))
    files.push_back(entry->path());
  if (failed) throw InputError(draft_.string(), 0, "cannot be read any more (" + failed.message() + "); run it again");
  for (const fs::path& file : files) {
    const fs::path target = folder_ / file.filename();
    std::error_code ignored;
    if (fs::is_directory(fs::symlink_status(target, ignored)))
      throw InputError(target.string(), 0,
                       "is a folder where a result is to go; nothing was written; remove or rename it");
  }
  for (const fs::path& file : files) {
    fs::rename(file, folder_ / file.filename(), failed);
    if (failed)
      throw InputError((folder_ / file.filename()).string(), 0, "cannot be replaced (" + failed.message() + ")");
  }
}

}  // namespace exitance
