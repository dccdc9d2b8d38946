#include "withy/core/analysis/recursion_members.hpp"

namespace withy::analysis {

template class Recursion<Dual<Jet>>;

}  // namespace withy::analysis
