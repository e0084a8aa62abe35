#include "src/dynamic/form_factor_column.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace exitance {
namespace {

std::uint64_t bytes_of(const FormFactorColumn& column) {
  return sizeof(FormFactorColumn) + column.F.capacity() * sizeof(double) +
         column.element.capacity() * sizeof(std::uint32_t);
}

}  // namespace

FormFactorColumn make_column(std::shared_ptr<const SceneVersion> version, std::uint32_t patch, std::uint64_t& tests) {
  const PatchMesh& mesh = version->mesh();
  std::vector<double> F(mesh.elements.size());
  std::vector<std::uint64_t> asked(mesh.patches.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.patches.size(), 16), [&](const auto& some) {
    PatchSight& sight = version->sight();
    for (std::size_t p = some.begin(); p < some.end(); ++p) {
      if (version->object_of_patch(static_cast<std::uint32_t>(p)) == SceneVersion::kVoid) continue;
      sight.set(static_cast<std::uint32_t>(p), patch);
      if (!sight.sees()) continue;
      const Patch& receiver = mesh.patches[p];
      asked[p] = receiver.element_count;
      for (std::uint32_t e = receiver.element_first; e < receiver.element_first + receiver.element_count; ++e)
        F[e] = sight.form_factor(e).F;
    }
  });
  for (const std::uint64_t count : asked) tests += count;
  FormFactorColumn column;
  const auto size = F.size() - static_cast<std::size_t>(std::ranges::count(F, 0.0));
  column.element.reserve(size);
  column.F.reserve(size);
  for (std::uint32_t e = 0; e < F.size(); ++e) {
    if (F[e] == 0) continue;
    column.element.push_back(e);
    column.F.push_back(F[e]);
  }
  column.version = std::move(version);
  return column;
}

FormFactorColumn changed_column(const FormFactorColumn& before, const VersionDifference& difference,
                                std::span<const FormFactorChange> changes) {
  FormFactorColumn after;
  after.version = difference.shared_after();
  const SceneVersion& now = *after.version;
  after.element.reserve(before.element.size() + changes.size());
  after.F.reserve(before.element.size() + changes.size());
  const auto add = [&](std::uint32_t element, double F) {
    if (F == 0) return;
    after.element.push_back(element);
    after.F.push_back(F);
  };
  auto change = changes.begin();
  for (std::size_t k = 0; k < before.element.size(); ++k) {
    const std::uint32_t e = before.element[k];
    for (; change != changes.end() && change->element < e; ++change) add(change->element, change->after);
    if (change != changes.end() && change->element == e) continue;
    if (now.has_element(e) && now.same_in(difference.before(), now.object_of_element(e))) add(e, before.F[k]);
  }
  for (; change != changes.end(); ++change) add(change->element, change->after);
  return after;
}

std::shared_ptr<const FormFactorColumn> ColumnStore::find(std::uint32_t patch) {
  if (patch >= places_.size() || !places_[patch].column) return nullptr;
  places_[patch].used = ++clock_;
  return places_[patch].column;
}

void ColumnStore::put(std::uint32_t patch, std::shared_ptr<const FormFactorColumn> column) {
  if (bytes_of(*column) > limit_) return;
  if (patch >= places_.size()) places_.resize(patch + 1);
  drop(patch);
  bytes_ += bytes_of(*column);
  places_[patch] = {std::move(column), ++clock_};
  while (bytes_ > limit_) {
    const auto age = [](const Place& place) { return place.column ? place.used : ~std::uint64_t{0}; };
    drop(static_cast<std::uint32_t>(std::ranges::min_element(places_, {}, age) - places_.begin()));
  }
}

void ColumnStore::drop(std::uint32_t patch) {
  if (!places_[patch].column) return;
  bytes_ -= bytes_of(*places_[patch].column);
  places_[patch].column.reset();
}

void ColumnStore::clear() {
  places_.clear();
  bytes_ = 0;
}

void ColumnStore::keep_versions(std::size_t count) {
  std::vector<std::uint64_t> serials;
  for (const Place& place : places_) {
    if (place.column) serials.push_back(place.column->version->serial());
  }
  std::ranges::sort(serials, std::greater<>());
  serials.erase(std::unique(serials.begin(), serials.end()), serials.end());
  if (serials.size() <= count) return;
  for (std::uint32_t p = 0; p < places_.size(); ++p) {
    if (places_[p].column && places_[p].column->version->serial() <= serials[count]) drop(p);
  }
}

}  // namespace exitance
