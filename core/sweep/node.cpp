#include "withy/core/sweep/node.hpp"

namespace withy::sweep {

const Evaluation all_solved;

Evaluation singular_at(int body) noexcept { return {Evaluation::Outcome::singular, body}; }

}  // namespace withy::sweep
