#include <dlfcn.h>

#include <algorithm>
#include <cfenv>

#include "withy/bindings/fmu_load/instance.hpp"

namespace withy::fmu_load {
namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

Program::Program(std::unique_ptr<const Archive> archive, FmuDescription description)
    : archive_(std::move(archive)), description_(std::move(description)) {
  const char* own = platform(description_.version);
  const std::filesystem::path library = archive_->folder() / "binaries" / own / (description_.identifier + ".so");
  if (!std::filesystem::exists(library))
    throw FmuError("has no library for this platform, binaries/" + std::string(own) + '/' + description_.identifier +
                   ".so; it is for: " + (archive_->platforms().empty() ? "none" : joined(archive_->platforms())));
  // A library built for fast arithmetic sets the processor to flush small numbers to zero as it is loaded.
  std::fenv_t arithmetic;
  std::fegetenv(&arithmetic);
  handle_ = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  std::fesetenv(&arithmetic);
  if (handle_ == nullptr) throw FmuError("cannot be loaded: " + std::string(dlerror()));
}

Program::~Program() {
  if (handle_ != nullptr) dlclose(handle_);
}

void* Program::symbol(const char* name) const {
  void* found = dlsym(handle_, name);
  if (found == nullptr) throw FmuError("lacks the function " + std::string(name));
  return found;
}

std::unique_ptr<Instance> Program::instantiate() const {
  return description_.version == 2 ? make_instance2(*this) : make_instance3(*this);
}

std::string failed_call(const char* function, int status, const std::string& heard) {
  // In the order of both standards.
  constexpr const char* names[] = {"ok", "warning", "discard", "error", "fatal", "pending"};
  return std::string(function) + " gives " + names[std::clamp(status, 0, 5)] +
         (heard.empty() ? ", without a word" : ": " + heard);
}

}  // namespace withy::fmu_load
