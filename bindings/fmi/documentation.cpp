#include "withy/bindings/fmi/documentation.hpp"

#include <fmt/format.h>

#include "withy/bindings/fmi/xml.hpp"

namespace withy::fmi {
namespace {

const char* kind_text(const Variable& v) {
  using enum Variable::Kind;
  switch (v.kind) {
    case time:
      return "time";
    case state:
      return "output, state";
    case derivative:
      return "derivative";
    case input:
      return "input";
    case output:
      return "output";
    case parameter:
      return v.tunable ? "tunable parameter" : "parameter";
    case indicator:
      return "event indicator";
  }
  return "";
}

std::string preformatted(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out += escaped(text.substr(at, end - at)) + '\n';
    at = end + 1;
  }
  return out;
}

}  // namespace

std::string documentation_page(const Description& d, const study::Prepared& prepared, const Variables& variables) {
  const std::string title = escaped(prepared.title());
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{0}</title>\n"
      "<style>body{{font:15px sans-serif;max-width:60em;margin:2em auto}}td,th{{text-align:left;padding:.1em .8em .1em "
      "0}}pre{{background:#f4f4f4;padding:1em}}</style></head>\n<body>\n<h1>{0}</h1>\n"
      "<p>An FMU of FMI {1}.0 for {2}, made by withy " WITHY_VERSION
      " in the formulation <code>{3}</code>.</p>\n"
      "<ul>\n<li>Inputs are efforts of loads and what motions prescribe; outputs are the columns of <code>withy "
      "run</code>, in SI units.</li>\n"
      "<li>Parameters are numbers of the scene, set before initialization ends; tunable ones between steps and at "
      "events too.</li>\n"
      "<li>Co-simulation integrates with <code>{4}</code>, its tolerance that of the scene or of the importer.</li>\n"
      "<li>Derivatives of state derivatives are exact; those of other outputs are central differences of eighth "
      "order.</li>\n</ul>\n<h2>Variables</h2>\n<table>\n<tr><th>name</th><th>unit</th><th>what</th><th>start</th>"
      "<th>meaning</th></tr>\n",
      title, d.version,
      d.model_exchange ? d.co_simulation ? "model exchange and co-simulation" : "model exchange" : "co-simulation",
      escaped(prepared.scene.formulation_name), escaped(prepared.scene.integrator_name));
  for (const Variable& v : variables.all) {
    const bool starts =
        v.kind == Variable::Kind::state || v.kind == Variable::Kind::input || v.kind == Variable::Kind::parameter;
    page +=
        fmt::format("<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n", escaped(v.name),
                    escaped(v.unit), kind_text(v), starts ? number_text(v.start) : "", escaped(v.description));
  }
  return page + "</table>\n<h2>Scene</h2>\n<pre>" + preformatted(prepared.values.text()) + "</pre>\n</body>\n</html>\n";
}

}  // namespace withy::fmi
