// A plugin that misbehaves in the call that a scene or the environment names, as hostile.py asks for.
#include <unistd.h>

#include <cfenv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

#include "withy/core/model/model.hpp"
#include "withy/core/plugin/body.hpp"
#include "withy/core/plugin/entry.hpp"
#include "withy/core/plugin/load.hpp"

namespace {

using namespace withy;

/// What any call may do. `what` is "CALL-DEED"; a call by another name does nothing.
void act(const std::string& what, const std::string& call) {
  if (!what.starts_with(call + "-")) return;
  const std::string deed = what.substr(call.size() + 1);
  if (deed == "throws") throw std::runtime_error("out of order");
  if (deed == "number") throw 5;
  if (deed == "memory") throw std::bad_alloc();
  if (deed == "exit") std::exit(0);
  if (deed == "quick") std::quick_exit(0);
  if (deed == "round") std::fesetround(FE_UPWARD);
  if (deed == "flush") __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() ^ 0x8040);
}

class Hostile final : public Body {
 public:
  explicit Hostile(std::string what) : what_(std::move(what)) {
    shape_.particles.push_back({1, PointExpansion::rigid({1, 0, 0}, 0)});
    shape_.sections.push_back({Matrix3::Identity(), PointExpansion::rigid({1, 0, 0}, 0)});
    shape_.stiffness = shape_.damping = Eigen::MatrixXd::Zero(0, 0);
    shape_.length = 1;
  }
  const ModalShape& shape() const override {
    act(what_, "shape");
    return shape_;
  }
  std::optional<PointExpansion> station(const StationName&) const override {
    act(what_, "station");
    if (what_ == "station-none") return {};
    PointExpansion p = PointExpansion::rigid({1, 0, 0}, 0);
    if (what_ == "station-nan") p.X.x() = std::nan("");
    return p;
  }
  std::string stations() const override {
    act(what_, "stations");
    return "root";
  }
  std::vector<std::string> remarks() const override {
    act(what_, "remarks");
    return {};
  }

 private:
  std::string what_;
  ModalShape shape_;
};

class Bound final : public BoundLoad {
 public:
  explicit Bound(std::string what) : what_(std::move(what)) {}
  std::size_t scratch() const override { return 0; }
  void add(double t, std::span<const double>, std::span<const double>, std::span<double> efforts,
           std::span<double>) const noexcept override {
    act(what_, "add");
    if (t > 0.05) act(what_, "late");
    if (what_ == "add-nan") efforts[0] = std::numeric_limits<double>::quiet_NaN();
  }
  std::vector<double> discontinuities() const override {
    act(what_, "discontinuities");
    if (what_ == "discontinuities-nan") return {std::nan("")};
    return {};
  }
  double end() const override {
    act(what_, "end");
    return what_ == "end-nan" ? std::nan("") : 1;
  }
  void begin(State& state) const override {
    act(what_, "begin");
    if (what_ == "begin-nan") state.y[0] = std::nan("");
  }

 private:
  std::string what_;
};

class HostileLoad final : public Load {
 public:
  explicit HostileLoad(std::string what) : what_(std::move(what)) {}
  std::unique_ptr<BoundLoad> bind(const Model&) const override {
    act(what_, "bind");
    return what_ == "bind-null" ? nullptr : std::make_unique<Bound>(what_);
  }

 private:
  std::string what_;
};

std::unique_ptr<Body> make_body(const Value& p, const MakeContext&) {
  act(p.text_at("what"), "make");
  return p.text_at("what") == "make-null" ? nullptr : std::make_unique<Hostile>(p.text_at("what"));
}

std::unique_ptr<Load> make_load(const Value& p, const MakeContext&) {
  act(p.text_at("what"), "load");
  return p.text_at("what") == "load-null" ? nullptr : std::make_unique<HostileLoad>(p.text_at("what"));
}

void enroll(Enrollment& e) {
  const char* what = std::getenv("WITHY_HOSTILE");
  act(what == nullptr ? "" : what, "enroll");
  e.add<Body>(
      {.id = "hostile", .summary = "hostile", .parameters = {text("what", "deed").otherwise("")}, .make = &make_body});
  e.add<Load>({.id = "hostile-load",
               .summary = "hostile",
               .parameters = {text("what", "deed").otherwise("")},
               .make = &make_load});
}

}  // namespace

WITHY_PLUGIN(hostile, enroll);
