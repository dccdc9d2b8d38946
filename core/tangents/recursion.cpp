#include "withy/core/tangents/recursion_members.hpp"

namespace withy::analysis {

template class Recursion<double>;
template class Recursion<Jet>;

}  // namespace withy::analysis
