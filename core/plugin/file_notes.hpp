/// \file
/// Which files are read to make something: what is made, and every result of it, depends on them.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace withy {

/// Whoever reads a file in a factory says so with `add`; whoever calls factories and wants to know has one of these
/// alive on the same thread. The youngest is told.
class FileNotes {
 public:
  /// Receives the name as the scene has it, and the bytes that were read.
  using Note = std::function<void(const std::string& file, std::string_view bytes)>;

  explicit FileNotes(Note note);
  ~FileNotes();
  FileNotes(const FileNotes&) = delete;
  FileNotes& operator=(const FileNotes&) = delete;

  /// Does nothing where nobody wants to know.
  static void add(const std::string& file, std::string_view bytes);

 private:
  Note note_;
  FileNotes* before_;
};

}  // namespace withy
