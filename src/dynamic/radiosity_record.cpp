// The state of a solution in archives: DynamicRadiosity::write and read.

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "src/dynamic/dynamic_radiosity.h"
#include "src/solve/sums_archive.h"

namespace exitance {
namespace {

using Versions = std::span<const std::shared_ptr<const SceneVersion>>;

const std::shared_ptr<const SceneVersion>& version_with(std::uint64_t serial, Versions versions,
                                                        const ArchiveReader& file) {
  for (std::size_t k = versions.size(); k-- > 0;) {
    if (versions[k]->serial() == serial) return versions[k];
  }
  file.refuse(fmt::format("it speaks of a version {} of the scene", serial));
}

}  // namespace

void DynamicRadiosity::write(ArchiveWriter& file, const std::string& prefix) const {
  std::vector<std::uint64_t> serials, gatherings;
  std::vector<std::string> names;
  for (const Layer& layer : layers_) {
    const std::vector<CompensatedSum> shot(layer.shot.begin(), layer.shot.end());
    write_sums(file, fmt::format("{}shot_{}", prefix, serials.size()), shot);
    // How it is rounded depends on what had been gathered when it was asked for.
    if (layer.importance)
      file.write(fmt::format("{}importance_{}", prefix, serials.size()), std::span<const double>(*layer.importance));
    serials.push_back(layer.version->serial());
    names.push_back(layer.name);
  }
  for (const Gathering& gathering : gatherings_) {
    write_sums(file, fmt::format("{}gathered_{}", prefix, gatherings.size() / 3), gathering.G);
    for (const std::uint64_t value :
         {std::uint64_t{gathering.object}, gathering.version->serial(), std::uint64_t{gathering.patches}})
      gatherings.push_back(value);
  }
  file.write(prefix + "versions", std::span<const std::uint64_t>(serials));
  file.write(prefix + "changes", std::span<const std::string>(names));
  file.write(prefix + "gatherings", std::span<const std::uint64_t>(gatherings));
  write_sums(file, prefix + "H", H_);
  file.write(prefix + "B", std::span<const double>(B_));
  file.write(prefix + "unshot", std::span<const double>(unshot_));
  const std::uint8_t has_forgotten = has_forgotten_;
  file.write(prefix + "has_forgotten", std::span(&has_forgotten, 1));
}

/// Of those of its patches that have gathered.
void DynamicRadiosity::find_rows(Gathering& gathering) const {
  const SceneVersion& then = *gathering.version;
  const ObjectSlot& slot = then.slot(gathering.object);
  std::vector<PointRow> rows;
  std::uint32_t last = slot.element_first;
  for (std::uint32_t p = slot.patch_first; p < slot.patch_first + gathering.patches; ++p)
    last = then.mesh().patches[p].element_first + then.mesh().patches[p].element_count;
  rows.resize(last - slot.element_first);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.size(), 1), [&](const auto& some) {
    for (std::size_t k = some.begin(); k < some.end(); ++k)
      rows[k] = then.row(slot.element_first + static_cast<std::uint32_t>(k));
  });
  for (std::size_t k = 0; k < rows.size(); ++k)
    gathering.rows.put(slot.element_first + static_cast<std::uint32_t>(k), std::move(rows[k]));
}

void DynamicRadiosity::read(const ArchiveReader& file, const std::string& prefix, Versions versions) {
  const std::vector<std::uint64_t> serials = file.uint64s(prefix + "versions");
  const std::vector<std::string> names = file.texts(prefix + "changes");
  if (serials.empty() || names.size() != serials.size() || serials.back() != version().serial())
    file.refuse("it is of another version of the scene");
  const std::shared_ptr<const SceneVersion> now = shared_version();
  layers_.clear();
  for (std::size_t k = 0; k < serials.size(); ++k) {
    const std::vector<CompensatedSum> shot = sums_in(file, fmt::format("{}shot_{}", prefix, k));
    if (shot.size() != now->patches() * bands_) file.refuse("it is of another mesh");
    layers_.push_back({k + 1 == serials.size() ? now : version_with(serials[k], versions, file), names[k], {}, {}});
    layers_.back().shot.resize(shot.size());
    std::ranges::copy(shot, layers_.back().shot.begin());
    if (const std::string name = fmt::format("{}importance_{}", prefix, k); file.holds(name)) {
      std::vector<double> importance(now->patches());
      take(file, file.doubles(name), importance);
      layers_.back().importance = std::make_shared<const std::vector<double>>(std::move(importance));
    }
  }
  const std::vector<std::uint64_t> gatherings = file.uint64s(prefix + "gatherings");
  if (gatherings.size() % 3 != 0) file.refuse("its vectors do not fit each other");
  gatherings_.clear();
  for (std::size_t k = 0; k < gatherings.size() / 3; ++k) {
    const std::uint64_t object = gatherings[3 * k], serial = gatherings[3 * k + 1], patches = gatherings[3 * k + 2];
    const auto& then = serial == now->serial() ? now : version_with(serial, versions, file);
    if (object >= then->objects()) file.refuse("it is of another scene");
    const ObjectSlot& slot = then->slot(static_cast<std::uint32_t>(object));
    std::vector<CompensatedSum> G = sums_in(file, fmt::format("{}gathered_{}", prefix, k));
    if (patches > slot.patch_count || (!G.empty() && G.size() != std::size_t{slot.element_count} * bands_))
      file.refuse("it is of another mesh");
    gatherings_.push_back({static_cast<std::uint32_t>(object), then, ObjectRows(slot.element_first, slot.element_count),
                           static_cast<std::uint32_t>(patches), std::move(G)});
    find_rows(gatherings_.back());
  }
  take(file, sums_in(file, prefix + "H"), H_);
  take(file, file.doubles(prefix + "B"), B_);
  take(file, file.doubles(prefix + "unshot"), unshot_);
  const std::vector<std::uint8_t> has_forgotten = file.uint8s(prefix + "has_forgotten");
  if (has_forgotten.size() != 1) file.refuse("its vectors do not fit each other");
  has_forgotten_ = has_forgotten[0] != 0;
  differences_.clear();
}

}  // namespace exitance
