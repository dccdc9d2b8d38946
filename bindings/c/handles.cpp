#include "withy/bindings/c/handles.hpp"

#include <array>

namespace withy::c {
namespace {

/// What a handle is; null of none.
const char* name_of(Kind kind) {
  constexpr std::array names = {"library", "scene", "result", "simulation", "snapshot", "equations"};
  const std::uint64_t number = static_cast<std::uint64_t>(kind) - static_cast<std::uint64_t>(Kind::library);
  return number < names.size() ? names[number] : nullptr;
}

}  // namespace

std::string& why_no_library() noexcept {
  thread_local std::string why;
  return why;
}

void need(bool condition, const char* otherwise) {
  if (!condition) throw BadUse(otherwise);
}
void need_size(std::size_t got, std::size_t least, const char* array) {
  if (got != least)
    throw BadUse(std::string(array) + ": got an array of " + std::to_string(got) + " numbers; need " +
                 std::to_string(least));
}

void refuse(const Handle* handle, Kind wanted) noexcept {
  if (handle != nullptr && name_of(handle->kind) != nullptr)
    handle->tell({"got a handle of another kind, '", name_of(handle->kind), "'; need '", name_of(wanted), "'"});
}

withy_port port_at(const std::vector<host::Port>& ports, std::size_t index) {
  if (index >= ports.size()) return {nullptr, nullptr};
  return {ports[index].name.c_str(), ports[index].unit.c_str()};
}

}  // namespace withy::c

const char* withy_version(void) { return WITHY_VERSION; }

const char* withy_error(const void* handle) {
  if (handle != nullptr) return static_cast<const withy::c::Handle*>(handle)->error();
  const std::string& why = withy::c::why_no_library();
  return why.empty() ? "the handle is null" : why.c_str();
}

void withy_free(void* handle) { delete static_cast<withy::c::Handle*>(handle); }
