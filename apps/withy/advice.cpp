#include "withy/apps/withy/advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "withy/core/simulation/instants.hpp"

namespace withy::app {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr const char* polynomials = "orthogonal-polynomials";
/// Of the accuracy: what a reference's own error may be.
constexpr double most_reference_use = 0.25;
/// Of the accuracy: an error beyond this in an integration that is much more exact is the model's.
constexpr double clearly_inaccurate = 1.5;

/// Calls with each strain of each beam that has modes: body's map, strain's map.
template <class Function>
void for_each_strain(const Scene& scene, Function&& function) {
  for (const auto& [name, body] : scene.source.at("bodies").members()) {
    if (body.text_at("type") != "beam") continue;
    for (const char* strain : {"bending_y", "bending_z", "torsion"}) {
      const Value* s = body.find(strain);
      const Value* modes = s != nullptr ? s->find("modes") : nullptr;
      if (modes != nullptr && modes->number() > 0) function(body, *s, std::string(strain));
    }
  }
}

std::string family_of(const Value& strain) {
  const Value* family = strain.find("family");
  if (family == nullptr) return {};
  return family->kind() == Value::Kind::text ? family->text() : family->text_at("name");
}

/// Whether another basis of clamped beams means the same beams: all are clamped at the root and free at the tip, their
/// damping is not that of single modes, and no modal coordinate has a value at the start.
bool families_are_exchangeable(const Scene& scene) {
  bool fit = true;
  for_each_strain(scene, [&](const Value& body, const Value& strain, const std::string& kind) {
    const std::string family = family_of(strain);
    const Value* damping = body.find("damping_ratio");
    fit = fit && (kind == "torsion" || family == "clamped-free" || family == "clamped-loaded" ||
                  family == "craig-bampton" || family == polynomials);
    fit = fit && (damping == nullptr || damping->number() == 0);
  });
  const Layout& layout = scene.model->layout();
  for (const Slot& body : layout.bodies) {
    for (std::size_t i = 0; i < body.positions; ++i) fit = fit && scene.initial.y[body.position + i] == 0;
    for (std::size_t i = 0; i < body.speeds; ++i) fit = fit && scene.initial.y[layout.positions + body.speed + i] == 0;
  }
  return fit;
}

bool same_model(const TradePoint& a, const TradePoint& b) {
  return a.formulation == b.formulation && a.family == b.family && a.modes == b.modes && a.bodies == b.bodies;
}

std::string unit_key(const TradePoint& p) {
  return fmt::format("{} {} {} {}", p.formulation_text(), p.family, p.modes, p.integrator);
}

bool has_plates(const Scene& scene) {
  const auto& bodies = scene.source.at("bodies").members();
  return std::any_of(bodies.begin(), bodies.end(), [](const auto& b) { return b.second.text_at("type") == "plate"; });
}

/// Names of the scene's bodies that have modes, in its order; a beam in segments is one.
std::vector<std::string> flexible_bodies(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& [name, body] : scene.source.at("bodies").members()) {
    const std::string& of = name;
    const auto is_part = [&](const BodyNode& b) {
      return b.body->shape().modes() > 0 && (b.segment ? b.segment->whole : b.name) == of;
    };
    const auto& nodes = scene.model->bodies();
    if (std::any_of(nodes.begin(), nodes.end(), is_part)) names.push_back(name);
  }
  return names;
}

bool flexible(const Model& model) {
  return std::any_of(model.bodies().begin(), model.bodies().end(),
                     [](const BodyNode& b) { return b.body->shape().modes() > 0; });
}

}  // namespace

Candidates candidates_for(const Engine& engine, const AdviseArguments& arguments) {
  Candidates c{arguments.formulations, arguments.families, arguments.modes, arguments.integrators,
               arguments.tolerances};
  for (const std::string& f : c.formulations) {
    if (f == "inconsistent")
      throw InputError(
          "--formulations: 'inconsistent' is never advised: it has the cost of consistent without its terms. "
          "See withy trade for its error");
    if (f == "auto") throw InputError("--formulations: 'auto' is a choice along a run, not a model; leave it out");
    if (engine.registry().find<Formulation>(f) == nullptr) throw InputError("no formulation '" + f + "'");
  }
  for (const int m : c.modes)
    if (m < 1 || m > 200) throw InputError(fmt::format("--modes: got {}; need 1 to 200", m));
  for (const double t : c.tolerances)
    if (!(t > 0 && t <= 1)) throw InputError(fmt::format("--tolerances: got {:g}; need above 0, at most 1", t));
  for (const std::string& i : c.integrators)
    if (engine.registry().find<Integrator>(i) == nullptr) throw InputError("no integrator '" + i + "'");
  if (!flexible(engine.model())) c.formulations = {"quadratic"};  // all are the same without a flexible body
  bool beams = false;
  bool polynomial_already = true;
  for_each_strain(engine.scene(), [&](const Value&, const Value& strain, const std::string& kind) {
    beams = true;
    if (kind != "torsion") polynomial_already = polynomial_already && family_of(strain) == polynomials;
  });
  if (!beams && !has_plates(engine.scene())) c.modes = {0};
  if (!beams) c.families = {""};
  if (c.families.empty()) {
    c.families = {""};
    if (!polynomial_already && families_are_exchangeable(engine.scene())) c.families.emplace_back(polynomials);
  }
  std::sort(c.tolerances.begin(), c.tolerances.end(), std::greater<>());
  std::sort(c.modes.begin(), c.modes.end());
  return c;
}

Advisor::Advisor(const Engine& engine, const AdviseArguments& arguments)
    : engine_(engine),
      arguments_(arguments),
      accuracy_(Accuracy::parse(arguments.accuracy)),
      outputs_(engine.model(), arguments.outputs),
      candidates_(candidates_for(engine, arguments)),
      best_(infinite) {
  if (has_switches(engine.model()))
    throw InputError(engine.scene().file +
                     ": a load switches at zeros of a function of the state, at times of their own in every model; "
                     "runs that are measured against each other need common ones");
  const bool lengths =
      outputs_.has(Measure::slide) || outputs_.has(Measure::place) || outputs_.has(Measure::deflection);
  if (!accuracy_.share && !(accuracy_.length && lengths) && !(accuracy_.angle && outputs_.has(Measure::angle)))
    throw InputError("--accuracy: '" + arguments.accuracy + "' asks nothing of the outputs, which are " +
                     std::string(lengths ? "lengths" : "angles"));
}

ProbedModel& Advisor::made(const TradePoint& point) {
  for (const auto& m : models_)
    if (same_model(m->point, point)) return *m;
  models_.push_back(std::make_unique<ProbedModel>(probed_model(engine_, arguments_, point)));
  return *models_.back();
}

const ProbedModel& Advisor::model_of(const TradePoint& point) { return made(point); }

std::optional<Reference> Advisor::reference_at(const TradePoint& point, std::string& trouble) {
  Reference r;
  r.point = point;
  ProbedModel& model = made(point);
  trouble = model.refusal;
  if (model.refused()) return {};
  r.walk = walk(model, *integrator_at(engine_.registry(), point), [&](const State& s) {
    std::vector<double> values;
    outputs_.read(*model.scene.model, *model.equations, s.y, values);
    r.values.push_back(std::move(values));
    outputs_.compare(r.values.back(), r.values.front(), r.ways);
    return true;
  });
  spent_ += r.walk.seconds;
  interrupted_ = interrupted_ || r.walk.end == Walk::End::interrupted;
  if (r.walk.end != Walk::End::reached) {
    trouble = fmt::format("{}: ends at {:.4g} s: {}", point.text(), r.walk.time, r.walk.reason);
    return {};
  }
  r.limits = accuracy_.limits(r.ways);
  return r;
}

/// Levels with one mode and one digit more each, until two in a row agree.
void Advisor::find_reference() {
  constexpr int first_modes = 2, levels = 6;
  constexpr double tightest = 1e-9;
  const bool modal = candidates_.modes.back() > 0;
  const std::string family =
      std::find(candidates_.families.begin(), candidates_.families.end(), polynomials) != candidates_.families.end()
          ? polynomials
          : "";
  TradePoint point{flexible(engine_.model()) ? "exact" : "quadratic",
                   family,
                   modal ? first_modes : 0,
                   "dop853",
                   std::clamp(1e-3 * accuracy_.share.value_or(1e-3), 1e-8, 1e-5),
                   {},
                   {}};
  std::string trouble;
  std::optional<Reference> coarse = reference_at(point, trouble);
  if (!coarse && !interrupted_ && point.formulation == "exact") {
    point.formulation = "quadratic";
    coarse = reference_at(point, trouble);
  }
  for (int level = 1; coarse && level < levels && !interrupted_; ++level) {
    if (modal) ++point.modes;
    point.tolerance = std::max(0.1 * point.tolerance, tightest);
    std::optional<Reference> fine = reference_at(point, trouble);
    if (!fine) break;
    for (std::size_t i = 0; i < fine->values.size(); ++i)
      outputs_.compare(fine->values[i], coarse->values[i], fine->own);
    // Candidates are not to have more modes than the truth.
    const bool rich = !modal || point.modes >= candidates_.modes.back() || fine->own_use() < 0.25 * most_reference_use;
    if (fine->own_use() <= most_reference_use && rich) {
      reference_ = std::move(fine);
      return;
    }
    coarse = std::move(fine);
  }
  if (interrupted_) return;
  if (!trouble.empty()) {
    trouble_ = "no reference to measure against: " + trouble;
  } else if (coarse) {
    trouble_ = fmt::format(
        "no reference is exact enough: two runs that differ by a mode and a digit, the finer {}, are still {:.2g} of "
        "the "
        "accuracy apart. Ask for {:.2g} times that accuracy, a shorter time (--set time.end=…) or fewer outputs",
        coarse->point.text(), coarse->own_use(), std::ceil(10 * coarse->own_use() / most_reference_use) / 10);
  }
}

std::vector<ProbedModel*> Advisor::models_by_cost() {
  std::vector<std::pair<double, ProbedModel*>> order;
  for (const std::string& formulation : candidates_.formulations) {
    for (const std::string& family : candidates_.families) {
      for (const int modes : candidates_.modes) {
        ProbedModel& m = made({formulation, family, modes, "", 0, {}, {}});
        // Explicit steps are as many as the fastest mode makes them.
        order.emplace_back(m.seconds * std::max(m.fastest, 1.0), &m);
      }
    }
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ProbedModel*> models;
  for (const auto& [cost, model] : order) models.push_back(model);
  return models;
}

double Advisor::unit_cost(const TradePoint& point) const {
  const std::string key = unit_key(point);
  for (const auto& [known, seconds] : unit_costs_)
    if (known == key) return seconds;
  return infinite;
}

void Advisor::note_unit_cost(const Probe& probe) {
  if (probe.walk.evaluations < 50) return;  // the start is not like the rest
  const double seconds = probe.walk.seconds / static_cast<double>(probe.walk.evaluations);
  const std::string key = unit_key(probe.point);
  for (auto& [known, least] : unit_costs_) {
    if (known != key) continue;
    least = std::min(least, seconds);
    return;
  }
  unit_costs_.emplace_back(key, seconds);
}

double Advisor::cost(const Probe& probe) const {
  const double unit = unit_cost(probe.point);
  return std::isfinite(unit) ? unit * static_cast<double>(probe.walk.evaluations) : probe.walk.seconds;
}

const Probe& Advisor::run(ProbedModel& model, const TradePoint& point, double most_use, double most_seconds) {
  Probe p = probe(engine_, model, point, outputs_, *reference_, most_use, most_seconds);
  note_unit_cost(p);
  spent_ += p.walk.seconds;
  interrupted_ = interrupted_ || p.outcome == Probe::Outcome::interrupted;
  if (p.passed()) best_ = std::min(best_, cost(p));
  probes_.push_back(std::move(p));
  return probes_.back();
}

/// A hundredth of the accuracy asked for, or the next candidate below it.
double Advisor::exact_enough_tolerance() const {
  double share = 1e-2;
  for (std::size_t m = 0; m < measures; ++m)
    if (reference_->ways[m] > 0) share = std::min(share, reference_->limits[m] / reference_->ways[m]);
  const double wanted = 1e-2 * share * (1 + 1e-9);
  for (const double t : candidates_.tolerances)
    if (t <= wanted) return t;
  return std::max(wanted, 1e-8);
}

void Advisor::try_model(ProbedModel& model) {
  if (model.refused()) {
    Probe p;
    p.point = model.point;
    p.reason = model.refusal;
    probes_.push_back(std::move(p));
    return;
  }
  // Is the model itself good enough? An integration that adds next to nothing tells, cut when that is clear. It may
  // cost more than the best so far, since a looser one of the same model may still cost less.
  TradePoint point = model.point;
  const double exact_enough = exact_enough_tolerance();
  point.integrator = "dop853";
  point.tolerance = exact_enough;
  const double before = best_;
  if (const Probe& gate = run(model, point, clearly_inaccurate, 4 * best_);
      gate.outcome == Probe::Outcome::inaccurate && gate.use > clearly_inaccurate)
    return;
  if (interrupted_) return;
  const auto is_candidate = [&] {
    return std::find(candidates_.integrators.begin(), candidates_.integrators.end(), point.integrator) !=
               candidates_.integrators.end() &&
           std::find(candidates_.tolerances.begin(), candidates_.tolerances.end(), point.tolerance) !=
               candidates_.tolerances.end();
  };
  if (!is_candidate()) {  // it has told what it can
    best_ = before;
    if (probes_.back().passed()) probes_.back().outcome = Probe::Outcome::too_costly;
  }
  for (const std::string& integrator : candidates_.integrators) {
    for (const double tolerance : candidates_.tolerances) {
      if (interrupted_) return;
      if (integrator == "dop853" && tolerance <= exact_enough && is_candidate()) break;
      point.integrator = integrator;
      point.tolerance = tolerance;
      const Probe& p = run(model, point, 1, 1.25 * best_);
      // Tighter ones cost more.
      if (p.passed() || p.outcome == Probe::Outcome::too_costly || p.outcome == Probe::Outcome::refused) break;
    }
  }
}

/// CPU time of another whole run [s], from which its unit cost may be seen to be less.
double Advisor::time_again(const Probe& p) {
  const Probe timed = probe(engine_, made(p.point), p.point, outputs_, *reference_, infinite, infinite);
  spent_ += timed.walk.seconds;
  note_unit_cost(timed);
  return timed.walk.seconds;
}

/// The cheapest that passed; those that are nearly as cheap are timed again first, since time is noisy.
void Advisor::choose() {
  choice_.reset();
  std::vector<Probe> again;
  for (const Probe& p : probes_)
    if (p.passed() && cost(p) <= 1.3 * best_) again.push_back(p);
  for (const Probe& p : again) {
    for (int i = 0; i < 2 && !interrupted_; ++i)
      if (time_again(p) > 0.2) break;
  }
  for (const Probe& p : probes_)
    if (p.passed() && (!choice_ || cost(p) < cost(*choice_))) choice_ = p;
}

/// Flexible bodies that need less than the rest: one after the other, the choice with that one `ruthless` too.
void Advisor::simplify_bodies() {
  if (!choice_ || choice_->point.formulation == "ruthless" || !allowed("ruthless")) return;
  const std::vector<std::string> bodies = flexible_bodies(engine_.scene());
  if (bodies.size() < 2) return;  // all of them were tried
  for (const std::string& body : bodies) {
    if (interrupted_ || choice_->point.bodies.size() + 1 == bodies.size()) return;
    TradePoint point = choice_->point;
    point.bodies.emplace_back(body, "ruthless");
    ProbedModel& model = made(point);
    if (model.refused()) continue;
    const double least = best_;
    const Probe mixed = run(model, point, 1, 4 * cost(*choice_));
    for (int i = 0; i < 2 && mixed.passed() && cost(mixed) >= cost(*choice_); ++i) time_again(mixed);
    if (mixed.passed() && cost(mixed) < cost(*choice_)) {
      choice_ = mixed;
    } else {
      best_ = least;
    }
  }
}

bool Advisor::allowed(const std::string& formulation) const {
  const auto& all = candidates_.formulations;
  return std::find(all.begin(), all.end(), formulation) != all.end();
}

bool Advisor::search() {
  find_reference();
  if (!reference_) return false;
  for (ProbedModel* model : models_by_cost()) {
    if (interrupted_) return false;
    try_model(*model);
  }
  choose();
  simplify_bodies();
  return choice_.has_value();
}

bool Advisor::reject_choice() {
  for (Probe& p : probes_)
    if (choice_ && p.point.key() == choice_->point.key()) p.outcome = Probe::Outcome::stopped;
  best_ = infinite;
  for (const Probe& p : probes_)
    if (p.passed()) best_ = std::min(best_, cost(p));
  choose();
  return choice_.has_value();
}

void Advisor::look_up() {
  above_.clear();
  if (!choice_ || !flexible(engine_.model())) return;
  std::vector<TradePoint> points;
  TradePoint up = choice_->point;
  if (!up.bodies.empty()) {
    up.bodies.clear();
  } else {
    up.formulation = up.formulation == "quadratic" ? "exact" : "quadratic";
  }
  if (!choice_->point.bodies.empty() || choice_->point.formulation != "exact") points.push_back(up);
  TradePoint richer = choice_->point;
  ++richer.modes;
  if (choice_->point.modes > 0) points.push_back(richer);
  for (const TradePoint& point : points) {
    if (interrupted_) return;
    const Probe p = probe(engine_, made(point), point, outputs_, *reference_, infinite, infinite);
    spent_ += p.walk.seconds;
    // What is chosen stays the cheapest by the costs it was chosen by.
    if (std::isinf(unit_cost(point))) note_unit_cost(p);
    interrupted_ = interrupted_ || p.outcome == Probe::Outcome::interrupted;
    above_.push_back(p);
  }
}

}  // namespace withy::app
