/// \file
/// The modal body: modes, mass integrals and stiffness from a file of Standard Input Data, as finite-element programs
/// write it. What the file does not determine is described at `integrals_of`.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "sid_body.hpp"
#include "withy/core/plugin/file_notes.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {
namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{256} << 20;

std::unique_ptr<Body> make_modal(const Value& p, const MakeContext& context) {
  const Value& named = p.at("file");
  const auto fault = [&](const std::string& why) -> std::unique_ptr<Body> {
    context.diagnostics.error(named.place(), fmt::format("got '{}'; {}", named.text(), why));
    return nullptr;
  };
  const std::filesystem::path file = std::filesystem::path(context.directory) / named.text();
  std::error_code none;
  constexpr const char* need = "need a file of Standard Input Data";
  if (!std::filesystem::exists(file, none)) return fault(fmt::format("there is no file '{}'; {}", file.string(), need));
  if (!std::filesystem::is_regular_file(file, none))
    return fault(fmt::format("'{}' is a folder, pipe or device; {}", file.string(), need));
  if (std::filesystem::file_size(file, none) > most_bytes) return fault("need a file of at most 256 MiB");
  std::ifstream stream(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  if (!stream) return fault(fmt::format("'{}' cannot be read", file.string()));
  FileNotes::add(named.text(), text);
  SidBodyOptions options;
  if (p.has("root")) options.root = p.text_at("root");
  if (BodyDamping::given(p)) {
    options.damping = BodyDamping::read(p, context.diagnostics);
    if (!options.damping) return nullptr;
  }
  try {
    SidReport report;
    return body_of(sid::read(text), options, report);
  } catch (const sid::FormatError& e) {
    return fault(e.what());
  } catch (const std::domain_error& e) {
    return fault(e.what());
  }
}

}  // namespace

void enroll_modal(Enrollment& enrollment) {
  std::vector<ParameterSpec> specs = {
      text("file", "file of Standard Input Data; a relative name starts at the scene's directory"),
      text("root", "node that is the root; without it, the frame the file refers to").optional()};
  // Given, they take the place of the file's damping.
  for (ParameterSpec& spec : damping_parameters(false)) specs.push_back(std::move(spec));
  enrollment.add<Body>(
      {.id = "modal",
       .summary = "Flexible body from a file of Standard Input Data (SID), as finite-element programs write it",
       .parameters = std::move(specs),
       .make = &make_modal});
}

}  // namespace withy
