#include "scaled_sid.hpp"

namespace withy::extremes {

sid::Data scaled(sid::Data data, const Gauge& gauge) {
  const double metre = gauge.factor("m"), newton = gauge.factor("N"), second = gauge.factor("s");
  const double kg = gauge.factor("kg");
  const auto times = [&](sid::Taylor& matrix, double factor) {
    matrix.m0 *= factor;
    for (Eigen::MatrixXd& m : matrix.m1) m *= factor / metre;
  };
  data.mass *= kg;
  for (sid::Node& node : data.nodes) {
    times(node.origin, metre);
    times(node.phi, 1);
    times(node.psi, 1 / metre);
    times(node.axes, 1);
  }
  times(data.J, kg * metre * metre);
  for (sid::Taylor* m : {&data.mdCM, &data.Cr, &data.Gr, &data.Oe}) times(*m, kg * metre);
  for (sid::Taylor* m : {&data.Ct, &data.Me, &data.Ge}) times(*m, kg);
  times(data.ksigma, newton);
  times(data.Ke, newton / metre);
  times(data.De, newton * second / metre);
  return data;
}

}  // namespace withy::extremes
