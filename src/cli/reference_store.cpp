#include "src/cli/reference_store.h"

#include <fmt/format.h>

#include <bit>
#include <utility>

#include "src/output/archive.h"
#include "src/scene/scene_hash.h"

namespace exitance {
namespace {

constexpr const char* kKind = "exitance frame references 1";

/// FNV-1a, 64 bits.
class Fingerprint {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) hash_ = (hash_ ^ (value >> (8 * byte) & 0xff)) * 0x100000001b3u;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

std::string key_of(const EditSession& session, const FrameReferences& references) {
  const SceneVersion& version = session.solution().version();
  Fingerprint mesh;
  for (std::uint32_t e = 0; e < version.elements(); ++e) {
    if (!version.has_element(e)) continue;
    const Element& element = version.mesh().elements[e];
    mesh.add(std::uint64_t{e});
    mesh.add(std::uint64_t{element.patch});
    for (int axis = 0; axis < 3; ++axis) mesh.add(element.sample[axis]);
    mesh.add(element.area);
  }
  return fmt::format("{} {:016x} {}", scene_hash(session.scene().scene()), mesh.value(),
                     references.gathers() ? "gathering" : "shots");
}

}  // namespace

ReferenceStore::ReferenceStore(std::filesystem::path file) : file_(std::move(file)) {
  if (file_.empty()) return;
  std::error_code ignored;
  if (!std::filesystem::exists(file_, ignored)) {
    refuse_unwritable();
    return;
  }
  const ArchiveReader archive(file_, kKind);
  const std::vector<std::string> keys = archive.texts("keys");
  for (std::size_t k = 0; k < keys.size(); ++k) kept_.emplace(keys[k], archive.doubles(fmt::format("B_{}", k)));
}

std::optional<std::vector<double>> ReferenceStore::find(const EditSession& session, FrameReferences& references,
                                                        const std::function<bool()>& stop) {
  const std::string key = key_of(session, references);
  const auto place = kept_.find(key);
  if (place != kept_.end()) {
    // Elements that are gone may have taken numbers behind the others, and nothing is known of them.
    std::vector<double> B = place->second;
    B.resize(session.solution().version().elements() * session.solution().bands());
    return B;
  }
  if (!file_.empty() && !is_new_) refuse_unwritable();
  auto found = references.find(session.solution(), stop);
  if (found) {
    kept_.emplace(key, *found);
    is_new_ = true;
  }
  return found;
}

/// Begins a file, of which nothing is left.
void ReferenceStore::refuse_unwritable() const {
  const ArchiveWriter draft(file_, kKind);
}

void ReferenceStore::save() {
  if (file_.empty() || !is_new_) return;
  ArchiveWriter archive(file_, kKind);
  std::vector<std::string> keys;
  for (const auto& [key, B] : kept_) {
    archive.write(fmt::format("B_{}", keys.size()), B);
    keys.push_back(key);
  }
  archive.write("keys", keys);
  archive.publish();
  is_new_ = false;
}

}  // namespace exitance
