#pragma once
// Form factors from the sample points of elements to all patches, by exact visibility or by rays.

#include <functional>
#include <span>

#include "src/form_factor/form_factor_matrix.h"
#include "src/output/progress.h"
#include "src/visibility/visibility.h"

namespace exitance {

struct PointRows {
  FormFactorMatrix F;  ///< elements × patches; exact visibility gives only what exceeds its error
  PointRowStatistics statistics;
};

/// Appends a row to the matrix.
void append(FormFactorMatrix& F, const PointRow& row);

/// Appends the rows of a matrix of as many columns.
void append(FormFactorMatrix& F, const FormFactorMatrix& more);

/// Rows of the elements `first` … `last` − 1. In parallel; any number of threads gives the same bits.
PointRows point_rows(const MeshVisibility& visibility, std::size_t first, std::size_t last);

/// The statistics of the rows of some elements, in any order; the rows are not kept. In parallel; any number of threads
/// gives the same. An element that is named twice counts twice.
PointRowStatistics point_row_statistics(const MeshVisibility& visibility, std::span<const std::size_t> elements,
                                        const Progress& progress = {});

/// Form factor F[e] from every element to one patch, with error bounds: a column, for shooting without a matrix. `stop`
/// is asked by any thread before each element; false when it said true and the column is not whole.
bool point_column(const MeshVisibility& visibility, std::size_t patch, std::span<double> F, std::span<double> F_error,
                  const std::function<bool()>& stop = {});

/// Form factor from the elements of one patch, averaged by area, to another patch: the pair integrated anew.
PointFormFactor patch_form_factor(const MeshVisibility& visibility, std::size_t receiver, std::size_t source);

/// Entries of a row expected per element, from a sample of at most 8 elements and 4,096 patches, spread evenly: for
/// estimates of memory. Between 0 and patches.
double expected_row_length(const MeshVisibility& visibility);

}  // namespace exitance
