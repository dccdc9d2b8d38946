/// \file
/// What is told of small motions about a state that turns, in sentences.
#include <fmt/format.h>

#include <cctype>

#include "withy/study/time_laws.hpp"
#include "withy/study/turning.hpp"

namespace withy::study {
namespace {

/// Empty of what stays balanced.
std::string balance_text(const TurnCheck& check, const char* where) {
  return check.steady ? "" : fmt::format(", and this state is balanced at {} alone", where);
}

/// Of a state where loads or motions repeat and no hinge moves by its rate.
std::string shaken_text(const TurnCheck& check) {
  return fmt::format(
      "The equations of small motions change with time, over the period of {:.6g} s by {:.2g} % of their greatest "
      "element{}: these are those of one instant and tell no stability. --floquet looks at the whole period.",
      check.turning.period, 100 * check.change, balance_text(check, "this instant"));
}

/// Of what the comparison of masses, stiffnesses and what depends on speeds at some angles does not show; else empty.
std::string text_of_few(const TurningModes& turn) {
  if (!turn.check.periodic()) return {};
  if (!turn.sampled.empty())
    return fmt::format(
        "What the sampled load{} '{}' make{} of small motions changes as the hinges turn{}: these are those of one "
        "frozen angle.",
        turn.sampled.size() > 1 ? "s" : "", fmt::join(turn.sampled, "', '"), turn.sampled.size() > 1 ? "" : "s",
        balance_text(turn.check, "this angle"));
  if (!turn.commanding.empty()) return commanding_text(turn.commanding);
  if (!turn.narrow.empty())
    return fmt::format(
        "The load '{}' acts in a narrow part of a turn{}: these are small motions beside it. --floquet looks at the "
        "whole turn.",
        turn.narrow, balance_text(turn.check, "some angles"));
  return {};
}

}  // namespace

std::string passing_text(const std::vector<std::string>& hinges) {
  return fmt::format(
      "{} '{}' {} and nothing holds {}: this is an instant of a motion and no state that stays. Give one at rest or in "
      "steady motion (--at), or hold hinges (--lock, --spin).",
      hinges.size() > 1 ? "The hinges" : "The hinge", fmt::join(hinges, "', '"), hinges.size() > 1 ? "move" : "moves",
      hinges.size() > 1 ? "them at their rates" : "it at its rate");
}

std::string uneven_text(const std::vector<std::string>& motions) {
  const bool many = motions.size() > 1;
  return fmt::format(
      "The motion{} '{}' {} not go on at the rate {} at this instant, and what is free feels it: this is balanced now "
      "and no state that stays. Choose a time at which {} (--at), or hold the hinge (--lock, --spin).",
      many ? "s" : "", fmt::join(motions, "', '"), many ? "do" : "does", many ? "they have" : "it has",
      many ? "they rest" : "it rests");
}

std::string take_away_text(const std::vector<std::string>& loads, std::size_t meant, const char* behind) {
  if (loads.empty()) return {};
  const char* it = meant > 1 ? "them" : "it";
  return fmt::format("take {} away{} ({}){}", it,
                     loads.size() > meant ? fmt::format(" with what measures {}", it) : std::string(),
                     set_to_null(loads), behind);
}

std::string timed_text(const TurningModes& turn) {
  const bool many = turn.timed.size() > 1;
  std::string advice =
      take_away_text(turn.without_timed, turn.timed.size(), ", or ") + "choose the time that is meant (--at).";
  advice.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(advice.front())));
  return fmt::format(
      "The load{} '{}' change{} with time, whatever moves, and what is free feels it: this is balanced at this instant "
      "and no state that stays. {}",
      many ? "s" : "", fmt::join(turn.timed, "', '"), many ? "" : "s", advice);
}

std::string shaking_text(const std::vector<std::string>& loads) {
  const bool many = loads.size() > 1;
  return fmt::format("the load{} '{}' change{} the equations of small motions with time", many ? "s" : "",
                     fmt::join(loads, "', '"), many ? "" : "s");
}

std::string commanding_text(const std::vector<std::string>& loads) {
  return fmt::format(
      "The hinges turn and what the sampled load{} '{}' command{} turns with them: this state is steady at this angle "
      "alone.",
      loads.size() > 1 ? "s" : "", fmt::join(loads, "', '"), loads.size() > 1 ? "" : "s");
}

std::string turn_text(const TurningModes& turn) {
  constexpr const char* no_stability = " Growth and decay are those of this instant and tell no stability.";
  const TurnCheck& check = turn.check;
  const Turning& turning = check.turning;
  if (!turn.passing.empty()) return passing_text(turn.passing) + no_stability;
  if (!turn.uneven.empty()) return uneven_text(turn.uneven) + no_stability;
  if (!turn.timed.empty()) return timed_text(turn) + no_stability;
  if (!turn.shaking.empty())
    return fmt::format(
        "At this state {}.{}{}", shaking_text(turn.shaking), no_stability,
        turn.floquet ? "" : " --floquet with --period looks at a period after which everything repeats.");
  if (const std::string text = text_of_few(turn); !text.empty()) return text + no_stability;
  if (!turning.problem.empty())
    return check.periodic()
               ? fmt::format(
                     "The equations of small motions change as the hinges move, by {:.2g} % of their greatest "
                     "element{}: these are those of one instant and tell no stability. A whole turn is not "
                     "looked at: {}.",
                     100 * check.change, balance_text(check, "this place"), turning.problem)
               : fmt::format(
                     "The equations of small motions stay the same over a turn of the slowest hinge; a whole "
                     "turn is not looked at: {}.",
                     turning.problem);
  if (turning.period == 0) return {};
  if (!turn.turns) return check.periodic() ? shaken_text(check) : std::string();
  if (!check.periodic())
    return fmt::format("The hinges turn once in {:.6g} s, and the equations of small motions stay the same.",
                       turning.period);
  return fmt::format(
      "The equations of small motions change with the hinges' angle, over a turn of {:.6g} s by {:.2g} % of their "
      "greatest element{}: these are those of one frozen angle and tell no stability. --floquet looks at the whole "
      "turn, --blades at three or more equal blades from where the rotor does not turn.",
      turning.period, 100 * check.change, balance_text(check, "this angle"));
}

}  // namespace withy::study
