#include "withy/core/tangents/recursion_members.hpp"

namespace withy::analysis {

template class Recursion<Dual<Jet>>;

}  // namespace withy::analysis
