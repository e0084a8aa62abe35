#include "src/dynamic/converged_reference.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "src/form_factor/form_factor_matrix.h"
#include "src/solve/gather.h"

namespace exitance {
namespace {

/// Entries of a column that are not 0, and bytes an entry takes as part of a column and of the matrix.
constexpr double kDensity = 0.5, kBytesAnEntry = 32;

/// Rows of form factors, by element.
FormFactorMatrix matrix_of(const std::shared_ptr<const SceneVersion>& version) {
  const auto patches = static_cast<std::uint32_t>(version->patches());
  std::vector<FormFactorColumn> columns(patches);
  FormFactorMatrix rows;
  rows.columns = patches;
  rows.row_first.assign(version->elements() + 1, 0);
  std::uint64_t tests = 0;
  for (std::uint32_t p = 0; p < patches; ++p) {
    if (version->object_of_patch(p) == SceneVersion::kVoid) continue;
    columns[p] = make_column(version, p, tests);
    for (const std::uint32_t e : columns[p].element) ++rows.row_first[e + 1];
  }
  std::partial_sum(rows.row_first.begin(), rows.row_first.end(), rows.row_first.begin());
  rows.column.resize(rows.row_first.back());
  rows.F.resize(rows.row_first.back());
  rows.F_error.assign(rows.row_first.back(), kPointTolerance);
  std::vector<std::uint64_t> next(rows.row_first.begin(), rows.row_first.end() - 1);
  for (std::uint32_t p = 0; p < patches; ++p) {
    for (std::size_t k = 0; k < columns[p].element.size(); ++k) {
      const std::uint64_t place = next[columns[p].element[k]]++;
      rows.column[place] = p;
      rows.F[place] = columns[p].F[k];
    }
    columns[p] = {};
  }
  return rows;
}

/// Of the session that finds references for a session with such options.
SessionOptions options_of_references(SessionOptions options, double tolerance) {
  options.method = UpdateMethod::redistribute;
  options.tolerance = tolerance;
  return options;
}

}  // namespace

std::vector<double> converged_reference(const DynamicRadiosity& state) {
  const SceneVersion& version = state.version();
  const FormFactorMatrix rows = matrix_of(state.shared_version());
  const auto n = static_cast<std::uint32_t>(version.elements());
  const Discretisation d = state.discretisation();
  const Solution solution = gather(make_system(d, rows), {.tolerance = 1e-13});
  std::vector<double> B = element_exitance(d, irradiance(rows, solution.B, d.bands));
  for (std::uint32_t e = 0; e < n; ++e) {
    if (!version.has_element(e))
      std::fill_n(B.begin() + static_cast<std::ptrdiff_t>(std::size_t{e} * d.bands), d.bands, 0.0);
  }
  return B;
}

FrameReferences::FrameReferences(const Scene& scene, const SessionOptions& options, const DynamicRadiosity& state,
                                 std::uint64_t memory, double tolerance) {
  const double entries =
      static_cast<double>(state.version().elements()) * static_cast<double>(state.version().patches()) * kDensity;
  if (entries * kBytesAnEntry < static_cast<double>(memory)) return;
  session_.emplace(scene, options_of_references(options, tolerance));
}

void FrameReferences::write(ArchiveWriter& file, const std::string& prefix) const {
  if (session_) session_->write(file, prefix);
}

FrameReferences FrameReferences::taken_up(const Scene& scene, const SessionOptions& options,
                                          std::span<const Edit> edits, const ArchiveReader& file,
                                          const std::string& prefix, double tolerance) {
  FrameReferences references;
  if (file.holds(prefix + "is_shown")) {
    references.session_.emplace(
        EditSession::taken_up(scene, options_of_references(options, tolerance), edits, file, prefix));
  }
  return references;
}

void FrameReferences::apply(const Edit& edit) {
  if (session_) session_->apply(edit);
}

std::optional<std::vector<double>> FrameReferences::find(const DynamicRadiosity& state,
                                                         const std::function<bool()>& stop) {
  if (!session_) return converged_reference(state);
  Budget all;
  all.interrupted = stop;
  if (session_->work(all).interrupted) return std::nullopt;
  return session_->solution().element_B();
}

ConvergenceError convergence_error(const SceneVersion& version, std::uint32_t bands,
                                   const std::vector<double>& reference, const std::vector<double>& was,
                                   const std::vector<double>& current) {
  std::vector<std::uint32_t> elements;
  for (std::uint32_t e = 0; e < version.elements(); ++e) {
    if (version.has_element(e)) elements.push_back(e);
  }
  const auto area = [&](std::uint32_t e) { return version.mesh().elements[e].area; };
  return convergence_error(elements, area, bands, reference, was, current);
}

}  // namespace exitance
