#include "withy/core/plugin/file_notes.hpp"

#include <utility>

namespace withy {
namespace {

thread_local FileNotes* youngest = nullptr;

}  // namespace

FileNotes::FileNotes(Note note) : note_(std::move(note)), before_(std::exchange(youngest, this)) {}

FileNotes::~FileNotes() { youngest = before_; }

void FileNotes::add(const std::string& file, std::string_view bytes) {
  if (youngest != nullptr) youngest->note_(file, bytes);
}

}  // namespace withy
