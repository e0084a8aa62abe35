#include "src/form_factor/point_rows.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "src/form_factor/row_blocks.h"

namespace exitance {
namespace {

using Observers = tbb::enumerable_thread_specific<std::unique_ptr<Observer>>;

constexpr std::size_t kBlock = 256;

/// The row of element(k) for k = 0 … count − 1, given to sink(row) in order.
template <class ElementOf, class Sink>
void observe(const MeshVisibility& visibility, std::size_t count, const ElementOf& element, const Progress& progress,
             const Sink& sink) {
  Observers observers([&] { return visibility.observer(); });
  for_each_row(
      count, kBlock, [&](std::size_t k) { return observers.local()->row(element(k)); }, sink,
      [&](std::size_t done) {
        if (progress) progress(static_cast<double>(done) / static_cast<double>(count), "form factors");
      });
}

}  // namespace

void append(FormFactorMatrix& F, const PointRow& row) {
  F.column.insert(F.column.end(), row.column.begin(), row.column.end());
  F.F.insert(F.F.end(), row.F.begin(), row.F.end());
  F.F_error.insert(F.F_error.end(), row.F_error.begin(), row.F_error.end());
  F.row_first.push_back(F.F.size());
}

void append(FormFactorMatrix& F, const FormFactorMatrix& more) {
  const std::uint64_t before = F.F.size();
  for (std::size_t r = 1; r < more.row_first.size(); ++r) F.row_first.push_back(before + more.row_first[r]);
  F.column.insert(F.column.end(), more.column.begin(), more.column.end());
  F.F.insert(F.F.end(), more.F.begin(), more.F.end());
  F.F_error.insert(F.F_error.end(), more.F_error.begin(), more.F_error.end());
}

PointRows point_rows(const MeshVisibility& visibility, std::size_t first, std::size_t last) {
  PointRows result;
  result.F.columns = static_cast<std::uint32_t>(visibility.mesh().patches.size());
  observe(
      visibility, last - first, [&](std::size_t k) { return first + k; }, {},
      [&](const PointRow& row) {
        append(result.F, row);
        result.statistics += row.statistics;
      });
  return result;
}

PointRowStatistics point_row_statistics(const MeshVisibility& visibility, std::span<const std::size_t> elements,
                                        const Progress& progress) {
  PointRowStatistics sum;
  observe(
      visibility, elements.size(), [&](std::size_t k) { return elements[k]; }, progress,
      [&](const PointRow& row) { sum += row.statistics; });
  return sum;
}

bool point_column(const MeshVisibility& visibility, std::size_t patch, std::span<double> F, std::span<double> F_error,
                  const std::function<bool()>& stop) {
  Observers observers([&] { return visibility.observer(); });
  std::atomic<bool> is_whole = true;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, visibility.mesh().elements.size(), 256), [&](const auto& range) {
    Observer& observer = *observers.local();
    for (std::size_t e = range.begin(); e < range.end(); ++e) {
      if (!is_whole || (stop && stop())) {
        is_whole = false;
        return;
      }
      const PointFormFactor f = observer.entry(e, patch);
      F[e] = f.F;
      F_error[e] = f.error;
    }
  });
  return is_whole;
}

PointFormFactor patch_form_factor(const MeshVisibility& visibility, std::size_t receiver, std::size_t source) {
  const std::unique_ptr<Observer> observer = visibility.observer();
  const PatchMesh& mesh = visibility.mesh();
  const Patch& patch = mesh.patches[receiver];
  PointFormFactor mean;
  for (std::uint32_t e = patch.element_first; e < patch.element_first + patch.element_count; ++e) {
    const PointFormFactor f = observer->entry(e, source);
    mean.F += f.F * mesh.elements[e].area / patch.area;
    mean.error += f.error * mesh.elements[e].area / patch.area;
  }
  return mean;
}

double expected_row_length(const MeshVisibility& visibility) {
  constexpr std::size_t kElements = 8, kPatches = 4096;
  const std::size_t n = visibility.mesh().elements.size(), patches = visibility.mesh().patches.size();
  const std::size_t rows = std::min(n, kElements), columns = std::min(patches, kPatches);
  if (rows == 0) return 0;
  const std::unique_ptr<Observer> observer = visibility.observer();
  std::size_t entries = 0;
  for (std::size_t k = 0; k < rows; ++k) {
    for (std::size_t c = 0; c < columns; ++c)
      entries += observer->entry(n * (2 * k + 1) / (2 * rows), patches * (2 * c + 1) / (2 * columns)).F > 0;
  }
  return static_cast<double>(entries) / static_cast<double>(rows * columns) * static_cast<double>(patches);
}

}  // namespace exitance
