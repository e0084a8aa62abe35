#pragma once
// A table of a TOML file, read key by key: what is missing, of the wrong type or unknown is an error that names its
// line.

#include <toml++/toml.h>

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/vec3.h"

namespace exitance {

class TomlTable {
 public:
  /// name: what the table is called in messages. The table must outlive this.
  TomlTable(const toml::table& table, std::string file, std::string name);

  /// Each of these marks the key as known; a value that is there but of another type throws InputError.
  bool has(std::string_view key) const { return table_.contains(key); }
  bool is_list(std::string_view key) const { return table_.get(key) && table_.get(key)->is_array(); }
  std::optional<std::string> string(std::string_view key);
  std::optional<double> number(std::string_view key);  ///< finite
  std::optional<std::int64_t> integer(std::string_view key);
  bool flag(std::string_view key);                   ///< false where it is not there
  std::optional<Vec3> vector(std::string_view key);  ///< three finite numbers
  std::optional<std::vector<double>> numbers(
      std::string_view key);  ///< one number, or a list of at least one; any value
  std::optional<TomlTable> table(std::string_view key);
  const toml::array* array(std::string_view key);       ///< null where it is not there
  std::vector<TomlTable> tables(std::string_view key);  ///< of an array of tables
  std::vector<std::string> keys() const;

  template <typename Value>
  Value require(std::string_view key, std::optional<Value> value) const {
    if (!value) fail(line(), "\"" + std::string(key) + "\" is missing; add it");
    return *std::move(value);
  }

  /// Throws InputError for the first key that was never asked for.
  void refuse_unknown_keys() const;

  std::uint32_t line() const;                         ///< where the table begins
  std::uint32_t line_of(std::string_view key) const;  ///< REQUIRES: the key is there
  const std::string& file() const { return file_; }
  [[noreturn]] void fail(std::uint32_t line, const std::string& what) const;  ///< throws an InputError

  /// Three finite numbers.
  Vec3 to_vector(const toml::node& node) const;

 private:
  const toml::node* find(std::string_view key);

  const toml::table& table_;
  std::string file_, name_;
  std::set<std::string, std::less<>> known_;
};

std::uint32_t line_of(const toml::node& node);

/// Throws InputError, with the line where the file is no TOML.
toml::table parse_toml(const std::filesystem::path& path);

}  // namespace exitance
