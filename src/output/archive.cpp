#include "src/output/archive.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "src/output/draft.h"

namespace exitance {
namespace {

constexpr hsize_t kChunkBytes = 1 << 19;
constexpr unsigned kDeflate = 1;  // what compresses does so at once
constexpr const char* kKind = "kind";

// Failures are told by what we throw, not by what the library prints.
class Silence {
 public:
  Silence() {
    // At the end of the program the library would write once more what it could not write before, and crash. Handles
    // close all that is to be closed.
    static const herr_t left_alone = H5dont_atexit();
    static_cast<void>(left_alone);
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

// Why the last call failed: what the system said, or else where in the library that began, in its words.
std::string reason() {
  std::string text;
  const auto take_first = [](unsigned n, const H5E_error2_t* error, void* to) -> herr_t {
    if (n == 0 && error->desc != nullptr) *static_cast<std::string*>(to) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &text);
  // "file write failed: time = …, filename = …, errno = …, error message = '…', buf = …"
  constexpr std::string_view kOfSystem = "error message = '";
  if (const std::size_t at = text.find(kOfSystem); at != std::string::npos) {
    const std::size_t first = at + kOfSystem.size();
    return text.substr(first, text.find('\'', first) - first);
  }
  std::ranges::replace(text, '\n', ' ');
  return text.empty() ? "HDF5 gives no reason" : text;
}

class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle(hid_t id, Close how) : id_(id), close_(how) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }

  hid_t id() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }
  herr_t close() { return close_(std::exchange(id_, H5I_INVALID_HID)); }

 private:
  hid_t id_;
  Close close_;
};

Handle string_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), length);
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

Handle create(const Draft& draft) {
  const Silence silence;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  // Without times, the same contents are the same bytes.
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation.id(), false);
  Handle file(H5Fcreate(draft.path().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose);
  if (!file) draft.refuse(reason());
  return file;
}

}  // namespace

DamagedFile::DamagedFile(const std::filesystem::path& path, const std::string& what)
    : InputError(path.string(), 0, what + "; make it anew or fetch an undamaged copy"), path_(path), damage_(what) {}

struct ArchiveWriter::File {
  Draft draft;
  Packing packing;
  Handle handle = create(draft);

  void write(const std::string& name, hid_t type, hsize_t count, const void* values) const {
    const Silence silence;
    const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const hsize_t in_a_chunk = std::clamp<hsize_t>(kChunkBytes / H5Tget_size(type), 1, std::max<hsize_t>(count, 1));
    require(H5Pset_chunk(layout.id(), 1, &in_a_chunk));
    require(H5Pset_shuffle(layout.id()));
    if (packing == Packing::small || H5Tget_class(type) != H5T_FLOAT) require(H5Pset_deflate(layout.id(), kDeflate));
    require(H5Pset_fletcher32(layout.id()));
    require(H5Pset_obj_track_times(layout.id(), false));
    Handle dataset(H5Dcreate2(handle.id(), name.c_str(), type, space.id(), H5P_DEFAULT, layout.id(), H5P_DEFAULT),
                   H5Dclose);
    require(dataset.id() < 0 ? -1 : 0);
    if (count > 0) require(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    require(dataset.close());
  }

  // Asks for the reason before anything else is closed, which would clear it.
  void require(herr_t result) const {
    if (result < 0) draft.refuse(reason());
  }
};

ArchiveWriter::ArchiveWriter(const std::filesystem::path& path, std::string_view kind, Packing packing)
    : file_(new File{.draft = Draft(path), .packing = packing}) {
  try {
    write(kKind, kind);
  } catch (...) {
    const Silence silence;  // closing writes once more
    file_.reset();
    throw;
  }
}

ArchiveWriter::~ArchiveWriter() {
  const Silence silence;
  file_.reset();
}

void ArchiveWriter::write(const std::string& name, std::span<const double> values) {
  file_->write(name, H5T_IEEE_F64LE, values.size(), values.data());
}

void ArchiveWriter::write(const std::string& name, std::span<const std::uint64_t> values) {
  file_->write(name, H5T_STD_U64LE, values.size(), values.data());
}

void ArchiveWriter::write(const std::string& name, std::span<const std::uint32_t> values) {
  file_->write(name, H5T_STD_U32LE, values.size(), values.data());
}

void ArchiveWriter::write(const std::string& name, std::span<const std::uint8_t> values) {
  file_->write(name, H5T_STD_U8LE, values.size(), values.data());
}

void ArchiveWriter::write(const std::string& name, std::span<const std::string> texts) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  std::string padded;
  padded.reserve(length * texts.size());
  for (const std::string& text : texts) padded.append(text).append(length - text.size(), '\0');
  const Handle type = string_type(length);
  file_->write(name, type.id(), texts.size(), padded.data());
}

void ArchiveWriter::write(const std::string& name, std::string_view text) {
  const std::string one(text);
  write(name, std::span(&one, 1));
}

void ArchiveWriter::publish() {
  const Silence silence;
  file_->require(file_->handle.close());
  file_->draft.publish();
}

struct ArchiveReader::File {
  std::filesystem::path path;
  Handle handle;

  [[noreturn]] void refuse(const std::string& what) const { throw DamagedFile(path, what); }

  // Hands the open dataset, its type and its length to `take`.
  template <typename Take>
  auto read(const std::string& name, Take take) const {
    const Silence silence;
    const Handle dataset(H5Dopen2(handle.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset) refuse(fmt::format("\"{}\" is missing or damaged ({})", name, reason()));
    const Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const Handle space(H5Dget_space(dataset.id()), H5Sclose);
    hsize_t count = 0;
    if (!type || !space || H5Sget_simple_extent_ndims(space.id()) != 1 ||
        H5Sget_simple_extent_dims(space.id(), &count, nullptr) != 1) {
      refuse(fmt::format("\"{}\" is no vector", name));
    }
    return take(dataset, type, static_cast<std::size_t>(count));
  }

  void read_values(const std::string& name, const Handle& dataset, hid_t type, void* to) const {
    if (H5Dread(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) < 0)
      refuse(fmt::format("\"{}\" is damaged ({})", name, reason()));
  }

  template <typename Number>
  std::vector<Number> numbers(const std::string& name, hid_t expected) const {
    return read(name, [&](const Handle& dataset, const Handle& type, std::size_t count) {
      if (H5Tequal(type.id(), expected) <= 0) refuse(fmt::format("\"{}\" holds values of another type", name));
      std::vector<Number> values(count);
      if (count > 0) read_values(name, dataset, expected, values.data());
      return values;
    });
  }

  std::vector<std::string> texts(const std::string& name) const {
    return read(name, [&](const Handle& dataset, const Handle& type, std::size_t count) {
      if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) != 0)
        refuse(fmt::format("\"{}\" holds no texts of fixed length", name));
      const std::size_t length = H5Tget_size(type.id());
      std::string padded(length * count, '\0');
      if (count > 0) read_values(name, dataset, type.id(), padded.data());
      std::vector<std::string> texts;
      texts.reserve(count);
      for (std::size_t i = 0; i < count; ++i) {
        const std::string_view text(padded.data() + i * length, length);
        texts.emplace_back(text.substr(0, text.find('\0')));
      }
      return texts;
    });
  }
};

namespace {

Handle open_archive(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(path.string(), 0, "no such file; check the path");
  if (std::filesystem::is_directory(path, ignored))
    throw InputError(path.string(), 0, "is a folder; name a file in it");
  const Silence silence;
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file) throw DamagedFile(path, fmt::format("cannot be opened as an HDF5 file ({})", reason()));
  return file;
}

}  // namespace

ArchiveReader::ArchiveReader(const std::filesystem::path& path, std::string_view kind)
    : file_(new File{path, open_archive(path)}) {
  if (!holds(kKind)) throw InputError(path.string(), 0, fmt::format("is not an archive of {}; name another", kind));
  if (const std::string found = text(kKind); found != kind)
    throw InputError(path.string(), 0, fmt::format("holds {}, not {}; name another file", found, kind));
}

ArchiveReader::ArchiveReader(ArchiveReader&&) noexcept = default;

ArchiveReader::~ArchiveReader() {
  const Silence silence;
  file_.reset();
}

std::vector<double> ArchiveReader::doubles(const std::string& name) const {
  return file_->numbers<double>(name, H5T_IEEE_F64LE);
}

std::vector<std::uint64_t> ArchiveReader::uint64s(const std::string& name) const {
  return file_->numbers<std::uint64_t>(name, H5T_STD_U64LE);
}

std::vector<std::uint32_t> ArchiveReader::uint32s(const std::string& name) const {
  return file_->numbers<std::uint32_t>(name, H5T_STD_U32LE);
}

std::vector<std::uint8_t> ArchiveReader::uint8s(const std::string& name) const {
  return file_->numbers<std::uint8_t>(name, H5T_STD_U8LE);
}

std::vector<std::string> ArchiveReader::texts(const std::string& name) const {
  return file_->texts(name);
}

std::string ArchiveReader::text(const std::string& name) const {
  const std::vector<std::string> found = texts(name);
  if (found.size() != 1) refuse(fmt::format("\"{}\" holds {} texts, not one", name, found.size()));
  return found.front();
}

bool ArchiveReader::holds(const std::string& name) const {
  const Silence silence;
  const htri_t exists = H5Lexists(file_->handle.id(), name.c_str(), H5P_DEFAULT);
  if (exists < 0) refuse(fmt::format("the list of its contents is damaged ({})", reason()));
  return exists > 0;
}

void ArchiveReader::refuse(const std::string& what) const {
  file_->refuse(what);
}

}  // namespace exitance
