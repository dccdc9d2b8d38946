// Every kind of bad scene and the message a user gets: the place in the file, the path, what is wrong, what is needed.
#include <gmock/gmock.h>

#include <ostream>

#include "scene_fixture.hpp"

namespace withy::test {
namespace {

struct BadScene {
  const char* kind;
  std::string from;  ///< in the good scene
  std::string to;
  const char* message;  ///< after the name of the file, the beginning of the whole report
};
/// Instead of its bytes, among them addresses.
void PrintTo(const BadScene& scene, std::ostream* out) { *out << scene.kind; }

const BadScene bad_scenes[] = {
    {"syntax_unclosed_list", "gravity: [0, -9.81, 0]", "gravity: [0, -9.81, 0",
     "3:5: syntax: a list in brackets goes on where it should end; is a ',' missing before here, or a ']'?"},
    {"syntax_tab_indentation", "    type: rigid", "\ttype: rigid", "6:2: syntax: a tab; indent with spaces, not tabs"},
    {"syntax_bad_indentation", "    mass: 20.0", "   mass: 20.0",
     "7:4: syntax: this line is indented otherwise than those that it belongs to, or a line before lacks its ':'"},
    {"syntax_missing_comma", "type: revolute, axis: [0, 0, 1], parent: world,",
     "type: revolute, axis: [0, 0, 1], parent: world",
     "18:66: syntax: a map in braces goes on where it should end; is a ',' missing before here, or a '}'?"},
    {"syntax_missing_colon", "    length: 0.9", "    length 0.9",
     "14:20: syntax: a ':' where none can stand; does the line before lack its own, or a text with ': ' its quotes?"},
    {"decimal_comma", "    length: 0.9", "    length: 0,9",
     "13:13: /bodies/boom/length: got \"0,9\": decimals stand behind a point, not a comma; need finite > 0 [m]"},
    {"syntax_unclosed_quote", "type: beam", R"(type: "beam)",
     "12:11: /bodies/boom/type: the quote that begins here is never closed"},
    {"control_byte", "mass: 20.0", "mass: \001", "7:11: byte 0x01 is not UTF-8 text; a scene is YAML or JSON"},
    {"not_utf8", "mass: 20.0", "mass: \377", "7:11: byte 0xff is not UTF-8 text; a scene is YAML or JSON"},
    {"unknown_top_level_key", "gravity:", "gravty:", R"(2:1: /gravty: unknown key "gravty"; did you mean 'gravity'?)"},
    {"unknown_key_in_body", "    length: 0.9", "    lenght: 0.9",
     "11:3: /bodies/boom/length: missing: length, undeformed; need finite > 0 [m]"},
    {"unknown_key_in_a_map_of_a_plugin", "modes: 2, family", "mode: 2, family",
     R"(15:33: /bodies/boom/bending_y/mode: unknown key "mode"; did you mean 'modes'?)"},
    {"unknown_key_in_hinge", "axis: [0, 0, 1], ", "axis: [0, 0, 1], axes: 1, ",
     R"(18:47: /hinges/shoulder/axes: unknown key "axes"; did you mean 'axis'?)"},
    {"unknown_key_in_time", "output: 0.1", "outputs: 0.1",
     R"(3:18: /time/outputs: unknown key "outputs"; did you mean 'output'?)"},
    {"duplicate_key", "    mass: 20.0", "    mass: 20.0\n    mass: 21.0",
     "8:5: /bodies/hub/mass: duplicate key 'mass'; it stands at 7:5 already"},
    {"duplicate_body", "  boom:", "  hub:", "11:3: /bodies/hub: duplicate key 'hub'; it stands at 5:3 already"},
    {"alias", "gravity: [0, -9.81, 0]", "gravity: &g [0, -9.81, 0]\nlimits: *g",
     "2:10: /gravity: anchors (&name) are not allowed"},
    {"anchor", "mass: 20.0", "mass: &m 20.0", "7:11: /bodies/hub/mass: anchors (&name) are not allowed"},
    {"tag", "mass: 20.0", "mass: !!float 20.0",
     R"(7:11: /bodies/hub/mass: tags are not allowed; got "tag:yaml.org,2002:float")"},
    {"second_document", "loads:", "---\nloads:", "20:1: a second document begins here; need one document"},
    {"key_is_a_list", "time: {", "[a, b]: {",
     "3:1: a list or map that is never closed, or stands as a key; need a name as key"},
    {"wrong_format_version", "withy/1", "withy/2",
     R"(1:9: /format: got "withy/2": did you mean 'withy/1'?; need one of: withy/1)"},
    {"missing_format", "format: withy/1", "name: x",
     "1:1: /format: missing: version of the scene format; need one of: withy/1"},
    {"missing_bodies", "bodies:", "loads: {}\nx-bodies:", "1:1: /bodies: missing; need a map of bodies"},
    {"missing_parameter", "    length: 0.9\n", "",
     "11:3: /bodies/boom/length: missing: length, undeformed; need finite > 0 [m]"},
    {"missing_type", "    type: beam\n", "",
     "11:3: /bodies/boom/type: missing; need one of: beam, modal, plate, rigid"},
    {"missing_child", ", child: boom", "",
     "19:3: /hinges/root/child: missing: what it carries: a body, or body.frame; need text"},
    {"wrong_unit", "length: 0.9", "length: 25 kg",
     R"(13:13: /bodies/boom/length: got "25 kg": 'kg' is a wrong unit here; need finite > 0 [m])"},
    {"unknown_unit", "length: 0.9", "length: 25 mmm",
     R"(13:13: /bodies/boom/length: got "25 mmm": unknown unit 'mmm'; did you mean 'mm'?; need finite > 0 [m])"},
    {"ambiguous_unit", "stiffness: 112", "stiffness: 1 kg/m s",
     R"(15:28: /bodies/boom/bending_y/stiffness: got "1 kg/m s": a product after '/' can be read in two ways; write 'kg/m/s' or 'kg/(m s)'; need finite > 0 [N m^2])"},
    {"hertz_is_not_radians_per_second", "period: 5", "frequency: 5 rad/s",
     R"(21:85: /loads/motor/frequency: got "5 rad/s": 'rad/s' is a wrong unit here; need finite > 0 [Hz])"},
    {"nan", "stiffness: 112", "stiffness: .nan",
     "15:28: /bodies/boom/bending_y/stiffness: got nan; need finite > 0 [N m^2]"},
    {"infinity", "mass: 20.0", "mass: .inf", "7:11: /bodies/hub/mass: got inf; need finite >= 0 [kg]"},
    {"nan_as_text", "stiffness: 112", "stiffness: nan",
     "15:28: /bodies/boom/bending_y/stiffness: got nan; need finite > 0 [N m^2]"},
    {"number_out_of_range_of_doubles", "mass: 20.0", "mass: 1e400",
     R"(7:11: /bodies/hub/mass: got "1e400": numbers are decimal, without leading zeros, ':' or '_', and within the range of doubles; need finite >= 0 [kg])"},
    {"octal_look", "mass: 20.0", "mass: 010",
     R"(7:11: /bodies/hub/mass: got "010": numbers are decimal, without leading zeros, ':' or '_', and within the range of doubles; need finite >= 0 [kg])"},
    {"sexagesimal_look", "mass: 20.0", "mass: 1:30",
     R"(7:11: /bodies/hub/mass: got "1:30": ':30' is no unit; need finite >= 0 [kg])"},
    {"hexadecimal", "mass: 20.0", "mass: 0x1f",
     R"(7:11: /bodies/hub/mass: got "0x1f": unknown unit 'x'; need finite >= 0 [kg])"},
    {"number_in_quotes", "mass: 20.0", R"(mass: "20")",
     R"(7:11: /bodies/hub/mass: got "20": a number in quotes is text; write it without quotes or with its unit; need finite >= 0 [kg])"},
    {"text_for_number", "mass: 20.0", "mass: heavy", R"(7:11: /bodies/hub/mass: got "heavy"; need finite >= 0 [kg])"},
    {"list_for_number", "mass: 20.0", "mass: [20]", "7:11: /bodies/hub/mass: got a list of 1; need finite >= 0 [kg]"},
    {"nothing_for_number", "mass: 20.0", "mass:", "7:5: /bodies/hub/mass: got nothing; need finite >= 0 [kg]"},
    {"no_is_not_a_number", "mass: 20.0", "mass: no", R"(7:11: /bodies/hub/mass: got "no"; need finite >= 0 [kg])"},
    {"negative_mass", "mass: 20.0", "mass: -1", "7:11: /bodies/hub/mass: got -1; need finite >= 0 [kg]"},
    {"zero_length", "length: 0.9", "length: 0", "13:13: /bodies/boom/length: got 0; need finite > 0 [m]"},
    {"negative_stiffness", "stiffness: 112", "stiffness: -112",
     "15:28: /bodies/boom/bending_y/stiffness: got -112; need finite > 0 [N m^2]"},
    {"triangle_inequality", "[0.01, 0.01, 0.01, 0, 0, 0]", "[1, 1, 3, 0, 0, 0]", "8:14: /bodies/hub/inertia: "},
    {"too_few_numbers", "[0, -9.81, 0]", "[0, -9.81]",
     "2:10: /gravity: got a list of 2; need a list of 3 finite numbers [m/s^2]"},
    {"text_in_a_vector", "[0, -9.81, 0]", "[0, down, 0]", R"(2:14: /gravity/1: got "down"; need finite [m/s^2])"},
    {"map_for_a_vector", "[0, -9.81, 0]", "{z: -9.81}",
     "2:10: /gravity: got a map; need a list of 3 finite numbers [m/s^2]"},
    {"fraction_of_a_mode", "modes: 2", "modes: 2.5",
     "15:40: /bodies/boom/bending_y/modes: got 2.5; need whole number >= 0 and <= 1000"},
    {"too_many_modes_for_the_family", "modes: 2", "modes: 999",
     "11:3: /bodies/boom: its modes bring the model to about 4465.0 GiB of memory; need at most 4: use fewer modes"},
    {"too_much_memory", "bending_y: {stiffness: 112, modes: 2, family: clamped-free}",
     "bending_y: {stiffness: 112, modes: 200}\n    bending_z: {stiffness: 112, modes: 200}",
     "11:3: /bodies/boom: its modes bring the model to about 144.0 GiB of memory; need at most 4: use fewer modes"},
    {"unknown_mode_family", "clamped-free", "clamped-fre",
     R"(15:51: /bodies/boom/bending_y/family: no mode-family plugin "clamped-fre"; did you mean 'clamped-free'?; available: )"},
    {"table_that_does_not_reach_the_tip", "mass_per_length: 1.3", "mass_per_length: [[0, 1.3], [0.8, 1.1]]",
     "14:22: /bodies/boom/mass_per_length: got a table from x = 0 to 0.8 m; need one from the root, 0, to the tip, 0.9 "
     "m"},
    {"table_with_a_value_out_of_range", "mass_per_length: 1.3", "mass_per_length: [[0, 1.3], [0.9, 0]]",
     "14:39: /bodies/boom/mass_per_length/1/1: got 0; need finite > 0 [kg/m]"},
    {"mode_family_with_unknown_option", "family: clamped-free", "family: {name: clamped-loaded, tip_mas: 2}",
     R"(15:74: /bodies/boom/bending_y/family/tip_mas: unknown key "tip_mas"; did you mean 'tip_mass'?)"},
    {"mode_family_with_bad_option", "family: clamped-free", "family: {name: clamped-loaded, tip_mass: -2 kg}",
     R"(15:84: /bodies/boom/bending_y/family/tip_mass: got "-2 kg"; need finite >= 0 [kg])"},
    {"mode_family_with_options_but_no_name", "family: clamped-free", "family: {tip_mass: 2}",
     "15:43: /bodies/boom/bending_y/family/name: missing; need one of: clamped-clamped, clamped-free"},
    {"mode_family_that_is_a_number", "family: clamped-free", "family: 3",
     "15:51: /bodies/boom/bending_y/family: got 3: put text that looks like a number in quotes; need the name of a "
     "mode "
     "family, or a map with its name and options"},
    {"mode_family_without_its_load", "family: clamped-free", "family: clamped-loaded",
     "15:51: /bodies/boom/bending_y/family: clamped-loaded: got no load at the tip; need tip_mass, tip_inertia or "
     "both"},
    {"mode_family_without_functions_for_torsion", "bending_y: {stiffness: 112, modes: 2, family: clamped-free}",
     "torsion: {stiffness: 112, inertia: 1, family: pinned-free}",
     "15:51: /bodies/boom/torsion/family: mode family 'pinned-free' has no functions for torsion"},
    {"unknown_body_plugin", "type: beam", "type: beem",
     R"(12:11: /bodies/boom/type: no body plugin "beem"; did you mean 'beam'?; available: beam, modal, plate, rigid)"},
    {"unknown_hinge_plugin", "type: weld", "type: wled",
     R"(19:16: /hinges/root/type: no hinge plugin "wled"; did you mean 'weld'?; available: )"},
    {"unknown_load_plugin", "type: hinge-effort", "type: hinge-efort",
     R"(21:17: /loads/motor/type: no load plugin "hinge-efort"; did you mean 'hinge-effort'?; available: )"},
    {"unknown_formulation", "format: withy/1", "format: withy/1\nformulation: quadratik",
     R"(2:14: /formulation/name: no formulation plugin "quadratik"; did you mean 'quadratic'?; available: auto, consistent, exact, general, inconsistent, linear, quadratic, rate-linear, ruthless, symmetric, symmetric-linear)"},
    {"unknown_formulation_of_a_body", "    type: beam", "    type: beam\n    formulation: ruthles",
     R"(13:18: /bodies/boom/formulation: no formulation plugin "ruthles"; did you mean 'ruthless'?; available: auto, consistent, exact, general, inconsistent, linear, quadratic, rate-linear, ruthless, symmetric, symmetric-linear)"},
    {"unknown_integrator", "format: withy/1", "format: withy/1\nintegrator: {name: dopri}",
     R"(2:20: /integrator/name: no integrator plugin "dopri"; did you mean 'dopri5'?; available: )"},
    {"unknown_option_of_the_integrator", "format: withy/1", "format: withy/1\nintegrator: {name: dopri5, tol: 1}",
     R"(2:28: /integrator/tol: unknown key "tol"; did you mean 'rtol'?)"},
    {"option_out_of_range", "format: withy/1", "format: withy/1\nintegrator: {rtol: 0}",
     "2:20: /integrator/rtol: got 0; need finite > 0 and <= 1"},
    {"library_path_for_a_plugin", "type: beam", "type: /tmp/evil.so",
     R"(12:11: /bodies/boom/type: no body plugin "/tmp/evil.so"; available: beam, modal, plate, rigid)"},
    {"plugin_name_is_a_number", "type: beam", "type: 5",
     "12:11: /bodies/boom/type: no body plugin 5; available: beam, modal, plate, rigid"},
    {"dangling_parent", "parent: hub.out", "parent: hubb.out",
     R"(19:30: /hinges/root/parent: no body "hubb"; did you mean 'hub'?)"},
    {"dangling_frame", "parent: hub.out", "parent: hub.oot",
     R"(19:30: /hinges/root/parent: body 'hub' has no frame "oot"; did you mean 'root'?)"},
    {"dangling_child", "child: boom", "child: broom",
     R"(19:46: /hinges/root/child: no body "broom"; did you mean 'boom'?)"},
    {"dangling_hinge_of_a_load", "hinge: shoulder", "hinge: sholder",
     R"(21:38: /loads/motor/hinge: no hinge "sholder"; did you mean 'shoulder'?)"},
    {"frame_of_the_world", "parent: world", "parent: world.origin",
     "18:55: /hinges/shoulder/parent: the world has no frames; place the hinge with its offset"},
    {"world_as_child", "child: boom", "child: world", "19:46: /hinges/root/child: the world cannot be a child"},
    {"two_parents", "loads:", "  again: {type: weld, parent: world, child: boom}\nloads:",
     "20:45: /hinges/again/child: body 'boom' is the child of hinge 'root' already; each body of a tree has one"},
    {"no_parent", "  root: {type: weld, parent: hub.out, child: boom}\n", "",
     "11:3: /bodies/boom: no hinge has this body as its child; each body hangs on one (type free for one that floats)"},
    {"cycle", "parent: world", "parent: boom",
     "18:3: /hinges/shoulder: the hinges shoulder, root make a ring that does not hang on the world; let one of their "
     "parents be world, and close the ring with constraints"},
    {"own_parent", "parent: hub.out", "parent: boom.tip",
     "19:3: /hinges/root: the hinge root hangs a body on itself; its parent is another body, or the world"},
    {"name_with_a_dot",
     "  hub:", "  hub.1:", R"(5:3: /bodies/hub.1: got name "hub.1"; names are made of letters, digits, '_' and '-')"},
    {"name_with_a_space", "  hub:", "  my hub:",
     R"(5:3: /bodies/my hub: got name "my hub"; names are made of letters, digits, '_' and '-')"},
    {"name_world", "  hub:", "  world:", R"(5:3: /bodies/world: got name "world"; 'world' is the name of the ground)"},
    {"name_begins_with_digit",
     "  motor:", "  1motor:", R"(21:3: /loads/1motor: got name "1motor"; names begin with a letter or '_')"},
    {"name_of_a_frame", "      out: ", "      o/ut: ",
     R"(10:7: /bodies/hub/frames/o/ut: got name "o/ut"; names are made of letters, digits, '_' and '-')"},
    {"frame_named_as_a_station", "    damping_ratio: 0.01", "    frames: {tip: {position: [1, 0, 0]}}",
     "16:14: /bodies/boom/frames/tip: 'tip' is a station of the body already; choose another name"},
    {"frame_at_an_unknown_station", "    damping_ratio: 0.01", "    frames: {f: {at: middle}}",
     R"(16:22: /bodies/boom/frames/f/at: no station "middle"; need root, tip, or a coordinate x from 0 to 0.900000 m)"},
    {"frame_beyond_the_tip", "    damping_ratio: 0.01", "    frames: {f: {at: 0.95}}",
     "16:22: /bodies/boom/frames/f/at: no station 0.95; need root, tip, or a coordinate x from 0 to 0.900000 m"},
    {"orientation_not_a_unit_quaternion", "{position: [0.0762, 0, 0]}", "{orientation: [1, 1, 0, 0]}",
     "10:26: /bodies/hub/frames/out/orientation: got a quaternion of norm 1.4142135623730951; need norm 1 within "
     "1e-06"},
    {"orientation_without_an_axis", "{position: [0.0762, 0, 0]}", "{orientation: {axis: [0, 0, 0], angle: 90 deg}}",
     "10:33: /bodies/hub/frames/out/orientation/axis: got an axis of length 0; need a direction"},
    {"orientation_in_metres", "{position: [0.0762, 0, 0]}", "{orientation: {xyz: [1 m, 0, 0]}}",
     "10:33: /bodies/hub/frames/out/orientation/xyz/0: "},
    {"offset_not_a_unit_quaternion", "child: hub}", "child: hub, offset: {orientation: [0, 0, 0, 0]}}",
     "18:96: /hinges/shoulder/offset/orientation: got a quaternion of norm 0; need norm 1 within 1e-06"},
    {"zero_axis", "axis: [0, 0, 1]", "axis: [0, 0, 0]", "18:36: /hinges/shoulder/axis: "},
    {"negative_end", "end: 1.0", "end: -1", "3:13: /time/end: got -1; need finite >= 0 [s]"},
    {"zero_output", "output: 0.1", "output: 0", "3:26: /time/output: got 0; need finite > 0 [s]"},
    {"too_many_outputs", "output: 0.1", "output: 1e-12",
     "3:18: /time/output: got 1e-12 s, which makes 1e+12 outputs; need at most 1e+08"},
    {"negative_deflection_limit", "format: withy/1", "format: withy/1\nlimits: {deflection: -1}",
     "2:22: /limits/deflection: got -1; need finite > 0"},
    {"motion_type", "loads:", "motions: {spin: {hinge: shoulder, rate: 1}}\nloads:",
     "20:11: /motions/spin/type: missing; need one of: "},
    {"output_without_a_type", "loads:", "outputs: {everything: true}\nloads:",
     "20:23: /outputs/everything: got true; need a map with 'type' and what that sensor takes"},
    {"output_of_unknown_type", "loads:", "outputs: {eye: {type: fram, of: boom}}\nloads:",
     R"(20:23: /outputs/eye/type: no sensor plugin "fram"; did you mean 'frame'?; available: )"},
    {"output_of_a_missing_frame", "loads:", "outputs: {eye: {type: frame, of: boom.tipp}}\nloads:",
     R"(20:34: /outputs/eye/of: no frame "boom.tipp"; did you mean 'boom.tip'?)"},
    {"output_seen_from_a_missing_frame", "loads:", "outputs: {eye: {type: frame, of: boom, in: hubb}}\nloads:",
     R"(20:44: /outputs/eye/in: no frame "hubb"; did you mean 'hub'?)"},
    {"output_of_a_missing_hinge", "loads:", "outputs: {turn: {type: hinge, hinge: sholder}}\nloads:",
     R"(20:38: /outputs/turn/hinge: no hinge "sholder"; did you mean 'shoulder'?)"},
    {"output_of_a_weld", "loads:", "outputs: {turn: {type: hinge, hinge: root}}\nloads:",
     "20:11: /outputs/turn: hinge 'root' does not move; a sensor of it needs one that has rates"},
    {"output_of_a_missing_load", "loads:", "outputs: {drive: {type: effort, hinge: shoulder, of: moter}}\nloads:",
     R"(20:54: /outputs/drive/of: no load "moter"; did you mean 'motor'?)"},
    {"output_of_a_motion_that_is_not_there",
     "loads:", "outputs: {drive: {type: effort, hinge: shoulder, of: motion}}\nloads:",
     "20:11: /outputs/drive: no motion moves hinge 'shoulder'"},
    {"output_beyond_the_tip", "loads:", "outputs: {bend: {type: section, of: boom, at: 1.2}}\nloads:",
     "20:11: /outputs/bend: body 'boom' ends at x = 0.9 m; there is no section at 1.2 m"},
    {"output_in_a_rigid_body", "loads:", "outputs: {bend: {type: section, of: hub, at: 0}}\nloads:",
     "20:11: /outputs/bend: body 'hub' is no beam, and has no sections; `type: reaction` gives what a "
     "hinge carries"},
    {"output_of_a_formula_that_does_not_end",
     "loads:", "outputs: {sum: {type: expression, value: \"2 * (t + 1\"}}\nloads:",
     R"(20:42: /outputs/sum/value: got "2 * (t + 1": expected ')' at character 11)"},
    {"output_of_an_unknown_function", "loads:", "outputs: {sum: {type: expression, value: cbrt(t)}}\nloads:",
     R"_(20:42: /outputs/sum/value: got "cbrt(t)": no function 'cbrt'; known: sqrt, abs, )_"},
    {"output_of_a_number_that_comes_later",
     "loads:", "outputs: {sum: {type: expression, value: 2 * w.x}, w: {type: gyro, of: hub}}\nloads:",
     "20:11: /outputs/sum: no number 'w.x' of an output that stands before; known: t"},
    {"output_with_the_name_of_a_hinge", "loads:", "outputs: {shoulder: {type: gyro, of: hub}}\nloads:",
     R"(20:11: /outputs/shoulder: got name "shoulder", which is that of a hinge; outputs need their own)"},
    {"initial_unknown_hinge", "loads:", "initial: {hinges: {sholder: {position: [1]}}}\nloads:",
     R"(20:20: /initial/hinges/sholder: no hinge "sholder"; did you mean 'shoulder'?)"},
    {"initial_wrong_count", "loads:", "initial: {hinges: {shoulder: {position: [1, 2]}}}\nloads:",
     "20:41: /initial/hinges/shoulder/position: got a list of 2; need one finite number"},
    {"initial_wrong_unit", "loads:", "initial: {hinges: {shoulder: {position: [1 m]}}}\nloads:",
     R"(20:42: /initial/hinges/shoulder/position/0: got "1 m": 'm' is a wrong unit here; need finite [rad])"},
    {"initial_modes_of_a_rigid_body", "loads:", "initial: {bodies: {hub: {modes: []}}}\nloads:",
     "20:20: /initial/bodies/hub: body 'hub' is rigid: it has no modes"},
    {"initial_unknown_key", "loads:", "initial: {hinges: {shoulder: {pos: [1]}}}\nloads:",
     R"(20:31: /initial/hinges/shoulder/pos: unknown key "pos"; known: position, rate)"},
    {"initial_after_the_end",
     "loads:", "initial: {time: 2}\nloads:", "3:8: /time/end: got 1; need at least the initial time, 2 s"},
    {"table_not_increasing", "law: sine, amplitude: 20, period: 5", "law: table, table: [[0, 1], [1, 2], [1, 3]]",
     "21:85: /loads/motor/table/2/0: got 1 after 1; the first column must increase"},
    {"table_with_ragged_rows", "law: sine, amplitude: 20, period: 5", "law: table, table: [[0, 1], [1]]",
     "21:76: /loads/motor/table/1: got a list of 1; need a list of rows of 2 finite numbers [s, N m], the first column "
     "increasing"},
    {"motion_that_locks_a_hinge_as_a_trajectory",
     "type: hinge-effort, hinge: shoulder, law: sine, amplitude: 20, period: 5",
     "type: pd-controller, law: motion, hinges: {shoulder: {stiffness: 1, damping: 1, motion: locked}}",
     "21:99: /loads/motor/hinges/shoulder/motion: 'locked' holds a hinge where it is; it is no trajectory to follow"},
    {"unknown_motion_as_a_trajectory", "type: hinge-effort, hinge: shoulder, law: sine, amplitude: 20, period: 5",
     "type: pd-controller, law: motion, hinges: {shoulder: {stiffness: 1, damping: 1, motion: {type: quintik, to: 1, "
     "duration: 1}}}",
     R"(21:106: /loads/motor/hinges/shoulder/motion/type: no motion plugin "quintik"; did you mean 'quintic'?)"},
    {"motion_as_a_trajectory_with_a_wrong_option",
     "type: hinge-effort, hinge: shoulder, law: sine, amplitude: 20, period: 5",
     "type: pd-controller, law: motion, hinges: {shoulder: {stiffness: 1, damping: 1, motion: {type: quintic, to: 1, "
     "duration: -1}}}",
     "21:132: /loads/motor/hinges/shoulder/motion/duration: got -1; need finite > 0 [s]"},
    {"law_motion_without_a_motion", "type: hinge-effort, hinge: shoulder, law: sine, amplitude: 20, period: 5",
     "type: pd-controller, law: motion, hinges: {shoulder: {stiffness: 1, damping: 1}}",
     "21:64: /loads/motor/hinges/shoulder: the law 'motion' needs 'motion'"},
    {"choice_of_another_law", "law: sine", "law: sinus",
     R"(21:53: /loads/motor/law: got "sinus": did you mean 'sine'?; need one of: constant, sine, table, steps)"},
    {"inertia_of_three_numbers", "[0.01, 0.01, 0.01, 0, 0, 0]", "[0.01, 0.01, 0.01]",
     "8:14: /bodies/hub/inertia: got a list of 3; need a list of 6 finite numbers [kg m^2]: elements xx, yy, zz, xy, "
     "xz, yz of the inertia matrix about the centre of mass, body axes"},
    {"axis_as_a_letter", "axis: [0, 0, 1]", "axis: -y",
     "18:36: /hinges/shoulder/axis: got \"-y\"; need a list of 3 finite numbers: axis, the same components in the "
     "hinge frames of parent and child; any length but zero, as [0, -1, 0]"},
    {"gravity_as_a_number", "[0, -9.81, 0]", "-9.81",
     "2:10: /gravity: got -9.81; need a list of 3 finite numbers [m/s^2]: acceleration of gravity, world axes"},
    {"integrator_by_the_name_of_another_program", "gravity:", "integrator: ode45\ngravity:",
     R"(2:13: /integrator/name: no integrator plugin "ode45"; did you mean 'dopri5'?)"},
    {"load_on_a_weld", "hinge: shoulder,", "hinge: root,",
     "21:3: /loads/motor: hinge 'root' holds its body still and has no rates; need one that moves"},
    {"start_of_a_free_hinge_as_a_position", "hinges:\n  shoulder: {type: revolute, axis: [0, 0, 1],",
     "initial: {hinges: {shoulder: {position: [0, 0, 1]}}}\nhinges:\n  shoulder: {type: free,",
     "17:41: /initial/hinges/shoulder/position: got a list of 3; need a list of 7 finite numbers, a unit quaternion w, "
     "x, y, z and x, y, z [m]; or a map with position, orientation"},
    {"parent_in_the_middle_of_a_beam", "child: boom}",
     "child: boom}\n  more: {type: weld, parent: boom.middle, child: hub}",
     R"(20:30: /hinges/more/parent: body 'boom' has no frame "middle"; known: root, tip; its frames name other places )"},
    {"output_of_a_place_without_a_frame", "loads:", "outputs: {end: {type: frame, of: boom.middle}}\nloads:",
     R"(20:34: /outputs/end/of: no frame "boom.middle"; known: hub, hub.root, hub.out, boom, boom.root, boom.tip; )"
     "frames of the body name its other places"},
    {"load_component_out_of_range", "hinge: shoulder,", "hinge: shoulder, component: 1,", "21:3: /loads/motor: "},
    {"bodies_as_a_list", "bodies:\n  hub:\n    type: rigid", "bodies: [hub]\nlimits:\n  hub:\n    type: rigid",
     "4:9: /bodies: got a list of 1; need a map of names"},
    {"body_as_a_text", "  boom:\n    type: beam", "  boom: beam\n  more:\n    type: beam",
     R"(11:9: /bodies/boom: got "beam"; need a map with 'type' and what that body takes)"},
};

class BadScenes : public SceneTest, public testing::WithParamInterface<BadScene> {};

TEST_P(BadScenes, AreReportedWithPlaceAndReason) {
  const std::string report = problems(replaced(good_scene, GetParam().from, GetParam().to), registry);
  EXPECT_THAT(report, testing::StartsWith(std::string("s.yaml:") + GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(Kinds, BadScenes, testing::ValuesIn(bad_scenes),
                         [](const auto& scene) { return std::string(scene.param.kind); });

class BadDocuments : public SceneTest {};

TEST_F(BadDocuments, ProblemsAreReportedAllAtOnceInTheOrderOfTheFile) {
  std::string text = replaced(good_scene, "mass: 20.0", "mass: -20.0");
  text = replaced(text, "length: 0.9", "lenght: 0.9");
  text = replaced(text, "modes: 2", "modes: many");
  text = replaced(text, "parent: hub.out", "parent: hubb.out");
  text = replaced(text, "period: 5", "period: 5 kg");
  EXPECT_EQ(problems(text, registry),
            "s.yaml:7:11: /bodies/hub/mass: got -20; need finite >= 0 [kg]\n"
            "s.yaml:11:3: /bodies/boom/length: missing: length, undeformed; need finite > 0 [m]\n"
            "s.yaml:13:5: /bodies/boom/lenght: unknown key \"lenght\"; did you mean 'length'?\n"
            "s.yaml:15:40: /bodies/boom/bending_y/modes: got \"many\"; need whole number >= 0 and <= 1000\n"
            "s.yaml:19:30: /hinges/root/parent: no body \"hubb\"; did you mean 'hub'?\n"
            "s.yaml:21:82: /loads/motor/period: got \"5 kg\": 'kg' is a wrong unit here; need finite > 0 [s]");
}

TEST_F(BadDocuments, WhatRestsOnAPartThatIsReportedIsNotReportedToo) {
  const std::string parts = R"(
constraints:
  loop: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: boom.tpi, b: world}
  other: {type: hinge, hinge: revolute, axis: [0, 0, 1], a: boom.tip, b: world}
outputs:
  closing: {type: reaction, constraint: loop}
  place: {type: frame, of: boom.tpi}
  twice: {type: expression, value: "2 * place.x", unit: m}
  drive: {type: effort, hinge: shoulder, of: motor}
  other_closing: {type: reaction, constraint: otter}
)";
  // Each fault alone is reported, once; so is a name that nothing bears.
  EXPECT_EQ(
      problems(replaced(good_scene, "law: sine", "law: sinus") + parts, registry),
      "s.yaml:21:53: /loads/motor/law: got \"sinus\": did you mean 'sine'?; need one of: constant, sine, table, "
      "steps\n"
      "s.yaml:24:60: /constraints/loop/a: no frame \"boom.tpi\"; did you mean 'boom.tip'?\n"
      "s.yaml:28:28: /outputs/place/of: no frame \"boom.tpi\"; did you mean 'boom.tip'?; frames of the body name its "
      "other places\n"
      "s.yaml:31:3: /outputs/other_closing: there is no constraint 'otter'");
}

TEST_F(BadDocuments, TheErrorCarriesPlaceAndMessageForPrograms) {
  try {
    parse_scene(replaced(good_scene, "mass: 20.0", "mass: -20.0"), "s.yaml", registry);
    FAIL() << "no error";
  } catch (const SceneError& e) {
    ASSERT_EQ(e.problems().size(), 1u);
    EXPECT_EQ(e.problems()[0].place.line, 7);
    EXPECT_EQ(e.problems()[0].place.column, 11);
    EXPECT_EQ(e.problems()[0].place.path, "/bodies/hub/mass");
    EXPECT_EQ(e.problems()[0].message, "got -20; need finite >= 0 [kg]");
  }
}

TEST_F(BadDocuments, WithoutAnEndCanBeReadButNotRun) {
  const Scene scene = parse_scene(replaced(good_scene, "end: 1.0, ", ""), "s.yaml", registry);
  EXPECT_FALSE(scene.end.has_value());
  try {
    (void)end_of_run(scene);
    FAIL() << "no error";
  } catch (const SceneError& e) {
    EXPECT_STREQ(e.what(),
                 "s.yaml:3:7: /time/end: missing, and no load or motion has an end of its own; need finite >= 0 [s]");
  }
}

TEST_F(BadDocuments, WithoutContentAreRefused) {
  EXPECT_EQ(problems("", registry), "s.yaml:1:1: empty; nothing to read");
  EXPECT_EQ(problems("# only a comment\n", registry), "s.yaml:1:1: empty; nothing to read");
  EXPECT_THAT(problems("just text", registry), testing::StartsWith("s.yaml:1:1: got \"just text\"; need a map"));
  EXPECT_THAT(problems("[1, 2]", registry), testing::StartsWith("s.yaml:1:1: got a list of 2; need a map"));
  EXPECT_THAT(problems("bodies: {}\nhinges: {}\nformat: withy/1\n", registry),
              testing::HasSubstr("s.yaml:1:9: /bodies: got none; need at least one body"));
}

TEST_F(BadDocuments, OfAHundredMegabytesAreRefusedBeforeTheyAreParsed) {
  const std::string text(std::size_t{100} << 20, ' ');
  EXPECT_EQ(problems(text, registry), "s.yaml:1:1: more than 64 MiB; a scene is at most that large");
}

TEST_F(BadDocuments, DeepNestingIsRefused) {
  EXPECT_THAT(problems("gravity: " + std::string(50'000'000, '['), registry),
              testing::HasSubstr("nested deeper than 32 levels"));
  EXPECT_THAT(problems("gravity: " + std::string(400, '[') + std::string(400, ']'), registry),
              testing::HasSubstr("nested deeper than 32 levels"));
  std::string map;
  for (int i = 0; i < 1000; ++i) map += "{a: ";
  EXPECT_THAT(problems("gravity: " + map, registry), testing::HasSubstr("nested deeper than 32 levels"));
  std::string block = "gravity:\n";
  for (int i = 1; i < 1000; ++i) block += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  EXPECT_THAT(problems(block, registry), testing::HasSubstr("nested deeper than 32 levels"));
}

TEST_F(BadDocuments, TooManyValuesAreRefused) {
  std::string row = "gravity: [";
  std::string column = "gravity:\n";
  for (int i = 0; i <= 1'000'000; ++i) {
    row += "0,";
    column += "- 0\n";
  }
  EXPECT_THAT(problems(row + "0]", registry), testing::HasSubstr("more than 1000000 values"));
  EXPECT_THAT(problems(column, registry), testing::HasSubstr("more than 1000000 values"));
  // Never closed, so that a parser would look for the end first.
  std::string open = "gravity: [";
  for (int i = 0; i < 8'000'000; ++i) open += "0,";
  EXPECT_THAT(problems(open, registry), testing::HasSubstr("more than 1000000 values"));
}

TEST_F(BadDocuments, AnAbsentFileIsASystemErrorThatNamesIt) {
  try {
    read_scene("no/such/scene.yaml", registry);
    FAIL() << "no error";
  } catch (const std::system_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("no/such/scene.yaml"));
    EXPECT_EQ(e.code(), std::errc::no_such_file_or_directory);
  }
  EXPECT_THROW(read_scene(WITHY_SOURCE_DIRECTORY, registry), std::system_error);
}

TEST_F(BadDocuments, TheGoodSceneIsGood) { EXPECT_EQ(problems(good_scene, registry), ""); }

}  // namespace
}  // namespace withy::test
