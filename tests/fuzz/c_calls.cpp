#include <algorithm>
#include <utility>
#include <vector>

#include "withy/bindings/c/withy.h"
#include "withy/tests/fuzz/calls.hpp"

namespace withy::fuzz {
namespace {

constexpr std::size_t slots = 2, most = 24;  // handles of a kind; states of the scene are fewer

/// A host that has a few handles of each kind, and now and then passes one of another kind or none.
class CHost {
 public:
  explicit CHost(std::string_view bytes) : choose_(bytes) {
    static withy_library* const shared = [] {
      withy_library* made = nullptr;
      expect(withy_library_create(nullptr, &made) == WITHY_OK, "no library");
      return made;
    }();
    library_ = shared;
  }
  CHost(const CHost&) = delete;
  CHost& operator=(const CHost&) = delete;
  ~CHost() {
    for (std::size_t k = 0; k < slots; ++k)
      for (void* handle : {static_cast<void*>(scenes_[k]), static_cast<void*>(simulations_[k]),
                           static_cast<void*>(snapshots_[k]), static_cast<void*>(equations_[k])})
        withy_free(handle);
  }
  void play() {
    parse();
    for (int calls = 0; choose_.any() && calls < 60; ++calls) {
      static constexpr void (CHost::*all[])() = {
          &CHost::parse,    &CHost::set,     &CHost::set_number,  &CHost::check,       &CHost::run,
          &CHost::simulate, &CHost::step,    &CHost::step,        &CHost::set_input,   &CHost::look,
          &CHost::snapshot, &CHost::restore, &CHost::equations,   &CHost::derivatives, &CHost::jacobian,
          &CHost::copy,     &CHost::end,     &CHost::wrong_handle};
      (this->*all[choose_.below(std::size(all))])();
    }
  }

 private:
  void said(withy_status status, const void* handle) {
    expect(status >= WITHY_OK && status <= WITHY_BAD_USE, "a status that is none");
    expect(status == WITHY_OK || handle == nullptr || *withy_error(handle) != '\0', "a bad status without a reason");
  }
  template <class T>
  T*& one(std::array<T*, slots>& all) {
    return all[choose_.below(slots)];
  }
  /// A slot for a new handle: the old one ends.
  template <class T>
  T** fresh(std::array<T*, slots>& all) {
    T*& slot = one(all);
    withy_free(slot);
    slot = nullptr;
    return choose_.maybe(&slot);
  }
  double* array() {
    numbers_.resize(most * most);
    for (std::size_t i = 0; i < most; ++i) numbers_[i] = 0.1 * choose_.number();
    return choose_.maybe(numbers_.data());
  }
  std::size_t size_of(const withy_equations* e) { return std::min(most, choose_.count(withy_equations_size(e))); }

  void parse() {
    withy_scene** slot = fresh(scenes_);
    std::string text = called_scene;
    if (choose_.rarely()) text.resize(text.size() * choose_.below(200) / 200);
    said(withy_scene_parse(library_, choose_.maybe(text.c_str()), choose_.maybe("fuzzed"), slot), library_);
  }
  void set() {
    constexpr const char* paths[] = {"formulation",      "bodies.boom.length", "loads.torque",
                                     "hinges.axle.type", "gravity.1",          "..",
                                     "bodies.boom",      "integrator"};
    constexpr const char* texts[] = {"linear",           "exact", "25 mm", "[0, 0, 1]",
                                     "{type: revolute}", "null",  "a: [",  "dopri5"};
    withy_scene* scene = one(scenes_);
    const char* path = choose_.maybe(paths[choose_.below(std::size(paths))]);
    said(withy_scene_set(scene, path, choose_.maybe(texts[choose_.below(std::size(texts))])), scene);
  }
  void set_number() {
    constexpr const char* paths[] = {"bodies.boom.length", "bodies.hub.mass", "loads.hold.sample", "gravity.2",
                                     "no.such"};
    withy_scene* scene = one(scenes_);
    said(withy_scene_set_number(scene, paths[choose_.below(std::size(paths))], choose_.number()), scene);
  }
  void check() {
    withy_scene* scene = one(scenes_);
    said(withy_scene_check(scene), scene);
  }
  void run() {
    withy_scene* scene = one(scenes_);
    withy_result* result = nullptr;
    said(withy_scene_run(scene, choose_.maybe(&result)), scene);
    std::vector<double> values(withy_result_rows(result) + 40);
    const withy_port column = withy_result_column(result, choose_.below(40));
    said(withy_result_values(result, column.name, choose_.maybe(values.data()),
                             choose_.count(withy_result_rows(result))),
         result);
    for (const char* text : {withy_result_status(result), withy_result_message(result), withy_result_json(result)})
      expect(text != nullptr, "a text that is none");
    expect(withy_result_column(result, withy_result_columns(result)).name == nullptr, "a column past the end");
    withy_free(result);
  }
  void simulate() {
    withy_scene* scene = one(scenes_);
    said(withy_simulation_create(scene, fresh(simulations_)), scene);
  }
  void step() {
    withy_simulation* s = one(simulations_);
    const double now = withy_simulation_time(s);
    const double t =
        choose_.rarely() ? std::min(now + 0.1, choose_.number()) : now + 0.01 * static_cast<double>(choose_.below(4));
    int reached = 0;
    said(choose_.below(2) == 0 ? withy_simulation_step(s, t)
                               : withy_simulation_advance_to(s, t, choose_.maybe(&reached)),
         s);
  }
  void set_input() {
    withy_simulation* s = one(simulations_);
    const std::size_t index = choose_.below(4);
    said(withy_simulation_set_input(s, index, choose_.number()), s);
    double value = 0;
    said(withy_simulation_input(s, index, &value), s);
    const char* name = withy_simulation_input_port(s, index).name;
    expect((name != nullptr) == (index < withy_simulation_inputs(s)), "an input past the end, or none before it");
    std::size_t found = 0;
    expect(name == nullptr || (withy_simulation_input_index(s, name, &found) == WITHY_OK && found == index),
           "an input that its own name does not find");
  }
  void look() {
    withy_simulation* s = one(simulations_);
    std::size_t index = 0;
    const withy_port port = withy_simulation_output_port(s, choose_.below(60));
    said(withy_simulation_output_index(s, choose_.rarely() ? "no such" : port.name, choose_.maybe(&index)), s);
    double value = 0;
    said(withy_simulation_output(s, index, choose_.maybe(&value)), s);
    std::vector<double> all(withy_simulation_outputs(s) + 40);
    said(withy_simulation_output_values(s, all.data(), choose_.count(withy_simulation_outputs(s))), s);
    const char* state = withy_simulation_state(s);
    expect(state != nullptr || s == nullptr || *withy_error(s) != '\0', "no state without a reason");
  }
  void snapshot() {
    withy_simulation* s = one(simulations_);
    said(withy_simulation_snapshot(s, fresh(snapshots_)), s);
  }
  void restore() {
    withy_simulation* s = one(simulations_);
    said(withy_simulation_restore(s, one(snapshots_)), s);
  }
  void equations() {
    withy_scene* scene = one(scenes_);
    constexpr const char* formulations[] = {nullptr, "ruthless", "linear", "quadratc"};
    said(withy_scene_set(scene, "loads.hold", "{type: input, hinge: axle}"),
         scene);  // of a sampled load there are none
    const char* formulation = formulations[choose_.below(4)];
    said(withy_equations_create(scene, formulation, fresh(equations_)), scene);
  }
  void derivatives() {
    withy_equations* e = one(equations_);
    double* y = array();
    std::vector<double> y_dot(most);
    const std::size_t n = size_of(e);
    expect(withy_equations_state_port(e, withy_equations_size(e)).name == nullptr, "a state past the end");
    if (choose_.below(2) == 0) said(withy_equations_initial(e, nullptr, y, n), e);
    said(withy_equations_set_input(e, "torque", choose_.number()), e);
    said(withy_equations_derivatives(e, choose_.number(), y, choose_.maybe(y_dot.data()), n), e);
  }
  void jacobian() {
    withy_equations* e = one(equations_);
    double* y = array();
    std::vector<double> J(most * most);
    said(withy_equations_jacobian(e, choose_.number(), y, size_of(e), choose_.maybe(J.data())), e);
    said(withy_equations_normalize(e, y, size_of(e)), e);
  }
  void copy() {
    withy_equations *from = equations_[0], *made = nullptr;
    said(withy_equations_copy(from, &made), from);
    withy_free(std::exchange(equations_[1], made));
    withy_scene *scene = scenes_[0], *other = nullptr;
    said(withy_scene_copy(scene, &other), scene);
    withy_free(std::exchange(scenes_[1], other));
  }
  void end() {
    switch (choose_.below(4)) {
      case 0:
        return withy_free(std::exchange(one(scenes_), nullptr));
      case 1:
        return withy_free(std::exchange(one(simulations_), nullptr));
      case 2:
        return withy_free(std::exchange(one(snapshots_), nullptr));
      default:
        return withy_free(std::exchange(one(equations_), nullptr));
    }
  }
  void wrong_handle() {
    void* other = choose_.below(2) == 0 ? static_cast<void*>(one(scenes_)) : static_cast<void*>(one(equations_));
    expect(withy_simulation_step(static_cast<withy_simulation*>(other), 1) == WITHY_BAD_USE, "a foreign handle steps");
    expect(withy_simulation_restore(one(simulations_), static_cast<withy_snapshot*>(other)) != WITHY_OK,
           "a foreign snapshot");
    expect(withy_scene_check(static_cast<withy_scene*>(static_cast<void*>(one(simulations_)))) == WITHY_BAD_USE,
           "a foreign scene");
  }

  Choices choose_;
  withy_library* library_ = nullptr;
  std::array<withy_scene*, slots> scenes_{};
  std::array<withy_simulation*, slots> simulations_{};
  std::array<withy_snapshot*, slots> snapshots_{};
  std::array<withy_equations*, slots> equations_{};
  std::vector<double> numbers_;
};

}  // namespace

void call_the_c_interface(std::string_view bytes) { CHost(bytes).play(); }

}  // namespace withy::fuzz
