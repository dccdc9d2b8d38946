#include "withy/bindings/fmi/model_description.hpp"

#include <fmt/format.h>

#include "withy/bindings/fmi/unit_definitions.hpp"
#include "withy/bindings/fmi/xml.hpp"

namespace withy::fmi {
namespace {

using Kind = Variable::Kind;

class Writer {
 public:
  Writer(const Description& d, const study::Prepared& p, const Variables& v) : d_(d), p_(p), v_(v) {}

  std::string write() {
    Xml::Attributes head{{"fmiVersion", d_.version == 2 ? "2.0" : "3.0"},
                         {"modelName", p_.scene.name.empty() ? d_.identifier : p_.scene.name},
                         {d_.version == 2 ? "guid" : "instantiationToken", d_.token},
                         {"generationTool", "withy " WITHY_VERSION},
                         {"variableNamingConvention", "flat"}};
    if (d_.version == 2) head.emplace_back("numberOfEventIndicators", std::to_string(v_.indicators));
    x_.open("fmiModelDescription", head);
    interfaces();
    write_units(x_, v_);
    x_.open("LogCategories");
    for (const LogCategory& c : log_category_list) x_.empty("Category", {{"name", c.name}, {"description", c.meaning}});
    x_.close();
    experiment();
    x_.open("ModelVariables");
    for (std::size_t i = 0; i < v_.all.size(); ++i) variable(i);
    x_.close();
    structure();
    return x_.close().text();
  }

 private:
  void interfaces() {
    const bool two = d_.version == 2;
    const char* state = two ? "canGetAndSetFMUstate" : "canGetAndSetFMUState";
    const char* serial = two ? "canSerializeFMUstate" : "canSerializeFMUState";
    const char* directional = two ? "providesDirectionalDerivative" : "providesDirectionalDerivatives";
    Xml::Attributes common{{"modelIdentifier", d_.identifier}, {state, "true"}, {serial, "true"}};
    if (p_.equations->linearization() != nullptr) {
      common.emplace_back(directional, "true");
      if (!two) common.emplace_back("providesAdjointDerivatives", "true");
    }
    if (d_.model_exchange) {
      Xml::Attributes a = common;
      a.emplace_back(two ? "completedIntegratorStepNotNeeded" : "needsCompletedIntegratorStep", two ? "true" : "false");
      x_.empty("ModelExchange", a);
    }
    if (!d_.co_simulation) return;
    Xml::Attributes a = common;
    a.emplace_back("canHandleVariableCommunicationStepSize", "true");
    if (two) {
      a.emplace_back("canNotUseMemoryManagementFunctions", "true");
    } else {
      a.insert(a.end(), {{"providesIntermediateUpdate", "true"},
                         {"mightReturnEarlyFromDoStep", "true"},
                         {"canReturnEarlyAfterIntermediateUpdate", "true"},
                         {"hasEventMode", "false"}});
    }
    x_.empty("CoSimulation", a);
  }

  void experiment() {
    Xml::Attributes a{{"startTime", number_text(p_.scene.initial.time)}};
    if (p_.scene.end) a.emplace_back("stopTime", number_text(*p_.scene.end));
    for (std::size_t i = 0; i < v_.parameters; ++i)
      if (const Variable& v = v_.all[v_.parameter(i)]; v.name == "integrator.rtol")
        a.emplace_back("tolerance", number_text(v.start));
    a.emplace_back("stepSize", number_text(p_.scene.output));
    x_.empty("DefaultExperiment", a);
  }

  void variable(std::size_t i) {
    const Variable& v = v_.all[i];
    const bool two = d_.version == 2;
    Xml::Attributes all{{"name", v.name}, {"valueReference", std::to_string(i)}}, type;
    if (!v.description.empty()) all.emplace_back("description", v.description);
    const auto is = [&](const char* causality, const char* variability, const char* initial) {
      all.insert(all.end(), {{"causality", causality}, {"variability", variability}});
      if (*initial != '\0') all.emplace_back("initial", initial);
    };
    switch (v.kind) {
      case Kind::time:
        is("independent", "continuous", "");
        break;
      case Kind::state:
        is("output", "continuous", v.approximate() ? "approx" : "exact");
        break;
      case Kind::derivative:
      case Kind::indicator:
        is("local", "continuous", "calculated");
        break;
      case Kind::input:
        is("input", "continuous", "");
        break;
      case Kind::output:
        is("output", "continuous", "calculated");
        break;
      case Kind::parameter:
        is("parameter", v.tunable ? "tunable" : "fixed", "exact");
        break;
    }
    if (!v.unit.empty()) type.emplace_back("unit", v.unit);
    if (v.minimum) type.emplace_back("min", number_text(*v.minimum));
    if (v.maximum) type.emplace_back("max", number_text(*v.maximum));
    if (v.kind == Kind::derivative) type.emplace_back("derivative", std::to_string(v_.state(v.index) + (two ? 1 : 0)));
    if (v.kind == Kind::state || v.kind == Kind::input || v.kind == Kind::parameter)
      type.emplace_back("start", number_text(v.start));
    if (two) {
      x_.open("ScalarVariable", all).empty("Real", type).close();
    } else {
      all.insert(all.end(), type.begin(), type.end());
      x_.empty("Float64", all);
    }
  }

  /// An unknown with what it depends on; null: on everything.
  void unknown(const char* name, std::size_t i, const std::vector<std::size_t>* on, const char* kind = "dependent") {
    const std::size_t first = d_.version == 2 ? 1 : 0;
    Xml::Attributes a{{d_.version == 2 ? "index" : "valueReference", std::to_string(i + first)}};
    if (on != nullptr) {
      std::string dependencies, kinds;
      for (const std::size_t k : *on) {
        dependencies += (dependencies.empty() ? "" : " ") + std::to_string(k + first);
        kinds += (kinds.empty() ? "" : " ") + std::string(kind);
      }
      a.insert(a.end(), {{"dependencies", dependencies}, {"dependenciesKind", kinds}});
    }
    x_.empty(name, a);
  }

  /// Of the derivatives of positions: the coordinates and rates of their own hinge or mode. Empty for speeds, which
  /// depend on all that moves and on every input.
  std::vector<std::vector<std::size_t>> position_dependencies() const {
    const Layout& layout = p_.model().layout();
    std::vector<std::vector<std::size_t>> on(v_.states);
    for (const Slot& hinge : layout.hinges) {
      std::vector<std::size_t> own;
      if (hinge.positions > 1)
        for (std::size_t i = 0; i < hinge.positions; ++i) own.push_back(v_.state(hinge.position + i));
      for (std::size_t i = 0; i < hinge.speeds; ++i) own.push_back(v_.state(layout.positions + hinge.speed + i));
      for (std::size_t i = 0; i < hinge.positions; ++i) on[hinge.position + i] = own;
    }
    for (const Slot& body : layout.bodies)
      for (std::size_t i = 0; i < body.positions; ++i)
        on[body.position + i] = {v_.state(layout.positions + body.speed + i)};
    return on;
  }

  void structure() {
    const bool two = d_.version == 2;
    std::vector<std::size_t> states(v_.states);
    for (std::size_t i = 0; i < v_.states; ++i) states[i] = v_.state(i);
    const auto positions = position_dependencies();
    x_.open("ModelStructure");
    if (two) x_.open("Outputs");
    const char* output = two ? "Unknown" : "Output";
    for (std::size_t i = 0; i < v_.states; ++i) {
      const std::vector<std::size_t> itself{v_.state(i)};
      unknown(output, v_.state(i), &itself, "constant");
    }
    for (std::size_t i = 0; i < v_.outputs; ++i)
      unknown(output, v_.output(i), v_.all[v_.output(i)].of_state_alone ? &states : nullptr);
    if (two) x_.close().open("Derivatives");
    for (std::size_t i = 0; i < v_.states; ++i)
      unknown(two ? "Unknown" : "ContinuousStateDerivative", v_.derivative(i),
              positions[i].empty() ? nullptr : &positions[i]);
    if (two) x_.close().open("InitialUnknowns");
    for (std::size_t i = 0; i < v_.states; ++i)
      if (v_.all[v_.state(i)].approximate()) unknown(two ? "Unknown" : "InitialUnknown", v_.state(i), nullptr);
    for (std::size_t i = 0; i < v_.states; ++i) unknown(two ? "Unknown" : "InitialUnknown", v_.derivative(i), nullptr);
    for (std::size_t i = 0; i < v_.outputs; ++i) unknown(two ? "Unknown" : "InitialUnknown", v_.output(i), nullptr);
    if (two) x_.close();
    if (!two)
      for (std::size_t i = 0; i < v_.indicators; ++i) unknown("EventIndicator", v_.indicator(i), nullptr);
    x_.close();
  }

  const Description& d_;
  const study::Prepared& p_;
  const Variables& v_;
  Xml x_;
};

}  // namespace

std::string model_description(const Description& description, const study::Prepared& prepared,
                              const Variables& variables) {
  return Writer(description, prepared, variables).write();
}

}  // namespace withy::fmi
