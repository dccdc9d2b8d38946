/// \file
/// Libraries, scenes and results in C.
#include <algorithm>
#include <cstddef>
#include <exception>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "withy/bindings/c/handles.hpp"

namespace host = withy::host;

using withy::c::good;
using withy::c::guarded;
using withy::c::make;
using withy::c::need;
using withy::c::need_size;
using withy::c::port_at;

namespace {

/// \throws withy::c::BadUse
void check(const withy_library_options& options) {
  need(options.size >= sizeof(withy_library_options), "options: need their size in its member `size`");
  need(options.plugin_count == 0 || options.plugins != nullptr, "options: plugins is null; need an array");
  for (std::size_t i = 0; i < options.plugin_count; ++i)
    need(options.plugins[i] != nullptr, "options: a name in plugins is null");
}

host::LibraryOptions own_options(const withy_library_options& options) {
  host::LibraryOptions own;
  for (std::size_t i = 0; i < options.plugin_count; ++i) own.plugins.emplace_back(options.plugins[i]);
  if (options.log != nullptr)
    own.log = [log = options.log, context = options.context](std::string_view remark) {
      log(context, std::string(remark).c_str());
    };
  return own;
}

}  // namespace

withy_status withy_library_create(const withy_library_options* options, withy_library** library) {
  const auto fail = [](withy_status status, const char* why) {
    try {
      withy::c::why_no_library() = why;
    } catch (...) {
      withy::c::why_no_library().clear();
    }
    return status;
  };
  if (library == nullptr) return fail(WITHY_BAD_USE, "need a place for the handle");
  *library = nullptr;
  try {
    if (options != nullptr) check(*options);
    *library = new withy_library(host::Library(options == nullptr ? host::LibraryOptions() : own_options(*options)));
    withy::c::why_no_library().clear();
    return WITHY_OK;
  } catch (const withy::c::BadUse& e) {
    return fail(WITHY_BAD_USE, e.what());
  } catch (const std::exception& e) {
    return fail(WITHY_ENVIRONMENT, e.what());
  } catch (...) {
    return fail(WITHY_ENVIRONMENT, "a plugin has thrown what is no exception of the standard library");
  }
}

withy_status withy_scene_read(withy_library* library, const char* file, withy_scene** scene) {
  return make(library, scene, [&] {
    need(file != nullptr, "need the name of a file");
    return host::Scene::read(library->value, file);
  });
}

withy_status withy_scene_parse(withy_library* library, const char* text, const char* name, withy_scene** scene) {
  return make(library, scene, [&] {
    need(text != nullptr, "need a text");
    return host::Scene::parse(library->value, text, name == nullptr ? "scene" : name);
  });
}

withy_status withy_scene_copy(withy_scene* scene, withy_scene** copy) {
  return make(scene, copy, [&] { return scene->value; });
}

withy_status withy_scene_set(withy_scene* scene, const char* path, const char* text) {
  return guarded(scene, [&] {
    need(path != nullptr && text != nullptr, "need a path and a text");
    scene->value.set(path, text);
  });
}

withy_status withy_scene_set_number(withy_scene* scene, const char* path, double value) {
  return guarded(scene, [&] {
    need(path != nullptr, "need a path");
    scene->value.set(path, value);
  });
}

withy_status withy_scene_check(withy_scene* scene) {
  return guarded(scene, [&] { scene->value.check(); });
}

withy_status withy_scene_run(withy_scene* scene, withy_result** result) {
  return make(scene, result, [&] { return scene->value.run(); });
}

const char* withy_result_status(const withy_result* r) { return good(r) ? r->value.status.c_str() : ""; }
const char* withy_result_message(const withy_result* r) { return good(r) ? r->value.message.c_str() : ""; }
const char* withy_result_json(const withy_result* r) { return good(r) ? r->value.json.c_str() : ""; }
size_t withy_result_rows(const withy_result* r) { return good(r) ? r->value.rows() : 0; }
size_t withy_result_columns(const withy_result* r) { return good(r) ? r->value.columns.size() : 0; }
withy_port withy_result_column(const withy_result* r, size_t index) {
  return good(r) ? port_at(r->value.columns, index) : withy_port{nullptr, nullptr};
}

withy_status withy_result_values(withy_result* result, const char* column, double* values, size_t count) {
  return guarded(result, [&] {
    need(column != nullptr && values != nullptr, "need a column and an array");
    const std::vector<double> numbers = result->value.column(column);
    need_size(count, numbers.size(), "values");
    std::copy(numbers.begin(), numbers.end(), values);
  });
}
