/// \file
/// The events of a scene: those that are reported alone, and those that act on hinges and loads.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "withy/core/model/event_plan.hpp"
#include "withy/core/simulation/run_event.hpp"
#include "withy/scene/check.hpp"
#include "withy/scene/event_triggers.hpp"

namespace withy {

/// Reads the events of one scene as its parts are made. Every problem goes to the checker's diagnostics.
class SceneEvents {
 public:
  /// \param events checked by grammar::scene_members, in the order of the file. The others must outlive the object.
  SceneEvents(Value events, const Document& document, const Checker& checker);

  /// Makes welds whose child is to be released hinges of type `free`, which are locked until then.
  void loosen(Value& hinges);
  /// Takes that back, in the values that the scene is kept as: they are to make the same scene again.
  void fasten(Value& hinges) const;
  /// Tells the model which hinges events lock or unlock, for sensors that are bound to it. Names that are wrong are
  /// reported by add_to.
  void expect_locks(Model& model) const;
  /// The load in all forms that events give it; as it is where they give it none.
  std::shared_ptr<const Load> with_forms(const std::string& name, std::shared_ptr<const Load> load);
  /// Adds the events that act to the model, which has its loads; the others to `plain`.
  /// \param outputs of the scene, which events may watch
  void add_to(Model& model, const std::vector<SensorNode>& outputs, std::vector<RunEvent>& plain);

 private:
  [[nodiscard]] bool acts(const std::string& name, const Value& event, const Watched& number) const;
  /// What the number passes; nothing, with a diagnostic, where that is given in another unit.
  [[nodiscard]] std::optional<double> passed_value(const std::string& event, const Watched& number) const;
  /// All but the number of a limit, which has no column yet.
  [[nodiscard]] ActingEvent acting_event(const Model& model, const std::string& name, const Value& given,
                                         const Watched& number) const;
  void add_actions(const Model& model, const std::string& name, const Value& asked, ActingEvent& event) const;
  void refuse_in_loops(const Model& model, const Value& asked) const;
  void add_hinge_actions(const Model& model, const Value& asked, const char* key, EventAction::Kind kind,
                         ActingEvent& event) const;
  void add_load_actions(const Model& model, const std::string& name, const Value& asked, ActingEvent& event) const;
  void add_releases(const Model& model, const Value& asked, ActingEvent& event) const;
  [[nodiscard]] std::vector<std::size_t> locked_at_start(const Model& model) const;
  void resolve_after(EventPlan& plan) const;
  [[nodiscard]] Value changed(const std::string& event, const std::string& load, const Value& given, bool& changes,
                              Diagnostics& diagnostics) const;
  [[nodiscard]] std::shared_ptr<const Load> form_of(const std::string& event, const std::string& load,
                                                    const Value& given) const;
  void tell_of_settings(const std::string& event, const std::string& load, const Value& given,
                        const std::vector<Diagnostic>& problems) const;

  Value events_;
  const Document& document_;
  const Checker& checker_;
  std::set<std::string> followed_;                               ///< events that others come after
  std::vector<std::string> held_;                                ///< hinges that were welds
  std::map<std::pair<std::string, std::string>, double> forms_;  ///< of an event and a load
};

}  // namespace withy
