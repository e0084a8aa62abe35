#pragma once
// Archives: HDF5 files of named vectors and texts in which damage is noticed.
//
// Every vector is chunked, shuffled, deflated (but see Packing) and has a Fletcher-32 checksum a chunk; texts are
// vectors of strings of a fixed length. Written in the format of HDF5 1.10, in which the rest of the file has checksums
// too. Any HDF5 tool reads them. The same contents are the same bytes. From one thread at a time: the library is not
// thread-safe.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "src/scene/input_error.h"

namespace exitance {

/// Thrown on reading a file that cannot be trusted. what() names the file and what of it is damaged or missing.
class DamagedFile : public InputError {
 public:
  DamagedFile(const std::filesystem::path& path, const std::string& what);

  const std::filesystem::path& path() const { return path_; }
  const std::string& damage() const { return damage_; }  ///< without the path, and without what to do about it

 private:
  std::filesystem::path path_;
  std::string damage_;
};

/// Form factors hardly compress, and trying to takes a seventh of the time that computing them takes.
enum class Packing {
  small,  ///< all is deflated
  quick   ///< doubles are not, for files that do not stay
};

class ArchiveWriter {
 public:
  /// Begins a draft beside `path`. kind: what the archive holds, for readers to know their own, as in
  /// "exitance form factors 1". Throws InputError when it cannot be written.
  ArchiveWriter(const std::filesystem::path& path, std::string_view kind, Packing packing = Packing::small);
  ~ArchiveWriter();
  ArchiveWriter(const ArchiveWriter&) = delete;
  ArchiveWriter& operator=(const ArchiveWriter&) = delete;

  /// Adds a vector, of any length, under a name that is not taken yet ("kind" is). Texts may be of any length and hold
  /// any byte but 0. Throws InputError when the system refuses.
  void write(const std::string& name, std::span<const double> values);
  void write(const std::string& name, std::span<const std::uint64_t> values);
  void write(const std::string& name, std::span<const std::uint32_t> values);
  void write(const std::string& name, std::span<const std::uint8_t> values);
  void write(const std::string& name, std::span<const std::string> texts);
  void write(const std::string& name, std::string_view text);  ///< read with ArchiveReader::text

  /// Puts the archive in place of `path`; without it nothing is left behind. Throws InputError.
  void publish();

 private:
  struct File;
  std::unique_ptr<File> file_;
};

class ArchiveReader {
 public:
  /// Throws InputError when there is no such file or it is of another kind, DamagedFile when it is no sound HDF5 file.
  ArchiveReader(const std::filesystem::path& path, std::string_view kind);
  ~ArchiveReader();
  ArchiveReader(ArchiveReader&&) noexcept;
  ArchiveReader(const ArchiveReader&) = delete;
  ArchiveReader& operator=(const ArchiveReader&) = delete;

  /// The vector of that name, its checksums verified. Throws DamagedFile, also when there is none or it has another
  /// type.
  std::vector<double> doubles(const std::string& name) const;
  std::vector<std::uint64_t> uint64s(const std::string& name) const;
  std::vector<std::uint32_t> uint32s(const std::string& name) const;
  std::vector<std::uint8_t> uint8s(const std::string& name) const;
  std::vector<std::string> texts(const std::string& name) const;
  std::string text(const std::string& name) const;

  bool holds(const std::string& name) const;

  /// Throws DamagedFile for what only the reader's caller can see ("row_first does not ascend").
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace exitance
