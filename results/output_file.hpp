/// \file
/// Files of which every byte is known to have been written: a full disk is an error, never a shorter file.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace withy {

/// A text file written from its beginning. What is written reaches the system some writes at a time, never a part of
/// one, so that a run that is killed leaves whole lines.
class OutputFile {
 public:
  /// \throws std::system_error naming the file, as do the other functions.
  /// \param append after what is there, or in its place
  explicit OutputFile(std::filesystem::path path, bool append = false);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();
  void write(std::string_view text);
  /// Gives the system all that was written.
  void flush();
  /// Makes what was written last through a loss of power.
  void sync();
  /// To be called once, last: closing may report what writing could not.
  void close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  [[noreturn]] void fail() const;
  bool hand_over() noexcept;

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::string waiting_;
};

/// The place where a file is written before it takes its name, whole or not at all. A link stays: what it leads to is
/// written. A pipe or a device is written as it is.
class Part {
 public:
  /// \throws study::InputError where the name is that of a folder
  explicit Part(const std::filesystem::path& file);
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  /// Removes what was written, but where it has taken its name.
  ~Part();
  /// Where to write.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Whether the file is a pipe or a device, which `path` is then, too.
  [[nodiscard]] bool is_stream() const { return path_ == file_; }
  /// It takes its name. To be called once it is written and closed. \throws std::system_error
  void finish();

 private:
  std::filesystem::path file_, path_;
  bool finished_ = false;
};

/// Writes a file by a Part. \throws std::system_error; study::InputError where the name is that of a folder
void write_file(const std::filesystem::path& path, std::string_view text);
/// The same of what is written part by part, and need not be in memory as a whole.
void write_file(const std::filesystem::path& path, const std::function<void(OutputFile&)>& write);
/// The same of a text, made to last through a loss of power.
void write_lasting_file(const std::filesystem::path& path, std::string_view text);

}  // namespace withy
