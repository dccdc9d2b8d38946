/// \file
/// A solver that is not withy's around the model exchange of FMI 3.0: CVODE with the exact Jacobian by directional
/// derivatives, its own root finding on the event indicators, stops at time events. It arrives where a run does.
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "withy/tests/fmi/same_as_run.hpp"

namespace withy::test {
namespace {

class CvodeAround {
 public:
  CvodeAround(Instance3& instance, const Unpacked& fmu) : i_(instance), fmu_(fmu) {
    const auto n = static_cast<sunindextype>(fmu.states.size());
    EXPECT_EQ(i_.fmi.GetNumberOfEventIndicators(i_.c, &indicators_), fmi3OK);
    EXPECT_EQ(SUNContext_Create(nullptr, &context_), 0);
    y_ = N_VNew_Serial(n, context_);
    matrix_ = SUNDenseMatrix(n, n, context_);
    solver_ = SUNLinSol_Dense(y_, matrix_, context_);
    event();
    read_states();
    cvode_ = CVodeCreate(CV_BDF, context_);
    EXPECT_EQ(CVodeInit(cvode_, &rates, 0, y_), CV_SUCCESS);
    EXPECT_EQ(CVodeSetUserData(cvode_, this), CV_SUCCESS);
    EXPECT_EQ(CVodeSStolerances(cvode_, 1e-10, 1e-12), CV_SUCCESS);
    EXPECT_EQ(CVodeSetMaxNumSteps(cvode_, 1000000), CV_SUCCESS);
    EXPECT_EQ(CVodeSetLinearSolver(cvode_, solver_, matrix_), CV_SUCCESS);
    EXPECT_EQ(CVodeSetJacFn(cvode_, &jacobian), CV_SUCCESS);
    EXPECT_EQ(CVodeRootInit(cvode_, static_cast<int>(indicators_), &roots), CV_SUCCESS);
  }
  ~CvodeAround() {
    CVodeFree(&cvode_);
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
    N_VDestroy(y_);
    SUNContext_Free(&context_);
  }
  CvodeAround(const CvodeAround&) = delete;
  CvodeAround& operator=(const CvodeAround&) = delete;

  void to(double end) {
    while (t_ < end) {
      const double limit = std::min(next_, end);
      ASSERT_EQ(CVodeSetStopTime(cvode_, limit), CV_SUCCESS);
      const int flag = CVode(cvode_, limit, y_, &t_, CV_NORMAL);
      ASSERT_GE(flag, 0) << i_.heard.last;
      ASSERT_EQ(put(t_, y_), fmi3OK) << i_.heard.last;
      if (flag != CV_ROOT_RETURN && t_ < next_) continue;
      ++(flag == CV_ROOT_RETURN ? found : passed);
      ASSERT_EQ(i_.fmi.EnterEventMode(i_.c), fmi3OK);
      event();
      read_states();
      ASSERT_EQ(CVodeReInit(cvode_, t_, y_), CV_SUCCESS);
    }
  }
  int found = 0, passed = 0, jacobians = 0;  ///< roots; time events; evaluations

 private:
  fmi3Status put(double t, N_Vector y) {
    const fmi3Status timed = i_.fmi.SetTime(i_.c, t);
    return timed != fmi3OK ? timed : i_.fmi.SetContinuousStates(i_.c, N_VGetArrayPointer(y), fmu_.states.size());
  }
  void read_states() {
    EXPECT_EQ(i_.fmi.GetContinuousStates(i_.c, N_VGetArrayPointer(y_), fmu_.states.size()), fmi3OK);
  }
  void event() {
    bool again = true, terminate = false, nominals = false, values = false, defined = false;
    double next = 0;
    while (again) {
      ASSERT_EQ(i_.fmi.UpdateDiscreteStates(i_.c, &again, &terminate, &nominals, &values, &defined, &next), fmi3OK)
          << i_.heard.last;
    }
    EXPECT_FALSE(terminate);
    next_ = defined ? next : 1e300;
    EXPECT_EQ(i_.fmi.EnterContinuousTimeMode(i_.c), fmi3OK);
  }
  static int rates(double t, N_Vector y, N_Vector y_dot, void* self) {
    auto& s = *static_cast<CvodeAround*>(self);
    if (s.put(t, y) != fmi3OK) return 1;
    return s.i_.fmi.GetContinuousStateDerivatives(s.i_.c, N_VGetArrayPointer(y_dot), s.fmu_.states.size()) != fmi3OK;
  }
  static int jacobian(double t, N_Vector y, N_Vector /*f*/, SUNMatrix J, void* self, N_Vector /*a*/, N_Vector /*b*/,
                      N_Vector /*c*/) {
    auto& s = *static_cast<CvodeAround*>(self);
    ++s.jacobians;
    if (s.put(t, y) != fmi3OK) return 1;
    const double one = 1;
    const std::size_t n = s.fmu_.states.size();
    for (std::size_t k = 0; k < n; ++k)
      if (s.i_.fmi.GetDirectionalDerivative(s.i_.c, s.fmu_.derivatives.data(), n, &s.fmu_.states[k], 1, &one, 1,
                                            SUNDenseMatrix_Column(J, static_cast<sunindextype>(k)), n) != fmi3OK)
        return 1;
    return 0;
  }
  static int roots(double t, N_Vector y, double* values, void* self) {
    auto& s = *static_cast<CvodeAround*>(self);
    if (s.put(t, y) != fmi3OK) return 1;
    return s.i_.fmi.GetEventIndicators(s.i_.c, values, s.indicators_) != fmi3OK;
  }

  Instance3& i_;
  const Unpacked& fmu_;
  std::size_t indicators_ = 0;
  double t_ = 0, next_ = 1e300;
  SUNContext context_ = nullptr;
  N_Vector y_ = nullptr;
  SUNMatrix matrix_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
  void* cvode_ = nullptr;
};

}  // namespace

TEST(Agreement, CvodeAroundModelExchangeArrivesWhereARunDoes) {
  for (const auto& [file, end] : {std::pair(commanded, 1.5), std::pair(jets, 12.0)}) {
    const host::Result run = exact_run(file, end);
    const Unpacked& fmu = exported(file, 3);
    Instance3 instance(fmu, false);
    instance.initialize();
    CvodeAround cvode(instance, fmu);
    cvode.to(end);
    // The command jumps at 0.6 and 1.2 s; the jets fire and stop.
    EXPECT_GE(cvode.found + cvode.passed, 2);
    EXPECT_GT(cvode.jacobians, 0);
    expect_same(
        fmu, [&](auto vr) { return instance.get(vr); }, run, run.rows() - 1, 1e-6);
  }
}

}  // namespace withy::test
