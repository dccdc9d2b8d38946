#include "withy/core/tangents/recursion_members.hpp"

namespace withy::analysis {

template class Recursion<Dual<double>>;

}  // namespace withy::analysis
