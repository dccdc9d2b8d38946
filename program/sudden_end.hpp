/// \file
/// Ends of the program that no command asked for.
#pragma once

namespace withy::program {

/// From here on a call of exit() or quick_exit() (only plugins make one) and an exception that must not leave its code
/// end the program with a message and ExitStatus::environment. A write past the limit of a file's size fails as others
/// do, in place of ending the program.
void watch_for_sudden_ends();
/// main() returns next: whatever runs after it is no part of a command.
void end_is_due() noexcept;

}  // namespace withy::program
