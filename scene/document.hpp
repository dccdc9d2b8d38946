/// \file
/// Reads YAML and JSON text into values with their places. Nothing outside this file knows the YAML library.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>

#include "withy/core/plugin/value.hpp"

namespace withy {

/// What a document may be at most; beyond it is refused before memory is spent.
struct DocumentLimits {
  static constexpr std::size_t bytes = std::size_t{64} << 20;
  static constexpr int depth = 32;
  static constexpr std::size_t values = 1'000'000;
  static constexpr std::size_t key_bytes = 256;
  static constexpr std::size_t path_bytes = std::size_t{256} << 20;  ///< of all values together
};

/// A document as it was read, before it is checked against anything.
struct Document {
  Value root;
  std::unordered_map<std::string, Place> keys;  ///< by path: where the key of a value stands
  std::string directory = {};                   ///< of its file; empty: the working directory
  std::string whole_directory = {};             ///< the same, whatever the working directory is; empty: not known

  /// Where relative names of files begin: the folder as messages name it, `directory`, where that is still the one that
  /// it was when the document was read; else the whole of it.
  [[nodiscard]] std::string directory_now() const;

  /// Where the key of the value at `path` stands, or else of the nearest ancestor that has one.
  [[nodiscard]] Place key_place(const std::string& path) const;
};

/// Where a text comes from when it is not a whole file: every place gets this line and begins at this path.
struct Origin {
  int line = 0;  ///< 0: count lines in the text
  std::string path;
};

/// Reads one document. Plain scalars are null (`null`, `~`, nothing), booleans (`true`, `false`), decimal numbers, the
/// numbers `.nan` and `.inf` (which checks refuse), otherwise text; quoted ones are text. Refused, each with its place:
/// syntax errors, bytes that are not UTF-8 text, duplicate keys, aliases, anchors, tags, further documents, and what
/// exceeds the limits.
/// \returns false where what was read is not to be relied on; lesser problems are reported and read over.
bool read_document(std::string_view text, const Origin& origin, Document& document, Diagnostics& diagnostics);

/// A folder from the root on, by the working directory as it is; as it is given where there is none.
std::string whole(const std::string& directory);
/// A folder that was `whole_directory` from the root on: as messages name it, where that still leads there; else whole.
std::string directory_now(const std::string& directory, const std::string& whole_directory);

/// The bytes of a file. \throws std::system_error where it cannot be read, is larger than DocumentLimits::bytes
/// (EFBIG), or is a pipe into which nobody writes (ETIMEDOUT).
std::string read_bytes(const std::string& file);

}  // namespace withy
