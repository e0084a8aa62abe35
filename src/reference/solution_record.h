#pragma once
// A solution with all that is needed to compare it with another one, in memory and in files.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "src/scene/patch_mesh.h"

namespace exitance {

/// What a solution is off by, as errors of comparison.h.
struct SolutionError {
  double total = 0;        ///< the sum of what follows
  double mesh = 0;         ///< estimated: what one degree more or less makes, and what gathering at points misses
  double integration = 0;  ///< bound, as far as the errors of form factors hold
  double solver = 0;       ///< bound
};

struct SolutionRecord {
  std::string source = {};      ///< where it was read from, for messages
  std::string scene = {};       ///< its name
  std::string scene_hash = {};  ///< scene_hash.h
  std::string unit = {};        ///< of B and H
  std::uint32_t bands = 0;
  PatchMesh mesh = {};                 ///< every piece has its loop
  std::uint32_t degree = 0;            ///< of the polynomials that B is on patches (patch_polynomials.h)
  std::vector<double> B = {}, H = {};  ///< means of each element and band; H may be missing
  SolutionError error = {};            ///< infinite where nothing is known of it
  std::string manifest = {};           ///< JSON: what made it, and how
};

/// 0.2126 R + 0.7152 G + 0.0722 B of three bands, of any other number their sum: one value an element. Throws
/// std::invalid_argument when there are not `bands` values for each element, or no band.
std::vector<double> luminance(std::span<const double> values, std::uint32_t bands, std::size_t elements);

/// An archive (archive.h). The mesh is one of RefinedMesh: each patch is a piece, followed by its elements', a piece
/// each. Throws std::invalid_argument for any other, InputError when the file cannot be written.
void write_solution_archive(const std::filesystem::path& path, const SolutionRecord& record);

/// What write_solution_archive wrote, bit for bit. Throws InputError when there is no such file or it is none,
/// DamagedFile when something in it is damaged.
SolutionRecord read_solution_archive(const std::filesystem::path& path);

/// What `solve` wrote in a folder: the constant B of elements and their faces from solution.vtp, the scene from
/// result.json. Corners of faces are merged there within 1e-12 of the scene's extent. Throws InputError with the file
/// (and line, where one is malformed).
SolutionRecord read_result_folder(const std::filesystem::path& folder);

/// An archive, or, where the path is that of a folder or of a solution.vtp in one, what `solve` wrote.
SolutionRecord read_solution(const std::filesystem::path& path);

}  // namespace exitance
