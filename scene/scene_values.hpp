/// \file
/// A scene as a value: what its file says, with the places it says it at, and the operations that vary it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "withy/scene/document.hpp"
#include "withy/scene/scene_error.hpp"

namespace withy {

class Model;
struct SceneOptions;
struct State;

/// The values of a scene before they are checked against plugins. A copy is a scene of its own; the arm's costs some
/// tens of microseconds. Operations throw nothing: what they find wrong is kept and reported by make_scene together
/// with every other problem, in the same words as if the file said it. Each takes an `origin`, which stands in
/// messages where a file's line would, as "--set 'time.end=2'" or "variation 3".
class SceneValues {
 public:
  /// Reads a file (YAML or JSON). \throws SceneError where it is no such text; std::system_error where it cannot be
  /// read.
  static SceneValues read(const std::string& file);
  /// The same from text. `name` stands for the file in messages; relative names of other files begin at its folder.
  static SceneValues parse(std::string_view text, const std::string& name);
  /// The same where that folder is known from the root on: `name` may be one that only the folder has that was the
  /// working directory when the text was read.
  static SceneValues parse(std::string_view text, const std::string& name, const std::string& folder);

  /// Puts a value at a path of keys with dots between them, as "bodies.link1.length" or "gravity.1", and makes the maps
  /// on the way that are missing. An element of a vector that is not there is put into its default. Bodies, hinges,
  /// loads, motions and frames have to be there where the path leads into them, or the value is not all of one: a map,
  /// with `type` but for frames. A null takes away what is there: the default holds, or there is no such part.
  SceneValues& set(std::string_view path, Value value, const std::string& origin);
  /// For a copy of `base` on which nothing was done but to set some paths, none of them within another, to numbers: the
  /// same paths are going to be set again, in the same order, to other numbers. What comes of that is as if `base` had
  /// been copied anew.
  void set_again(const SceneValues& base);
  /// The same from "path=value" with the value as in a file. \param origin empty: "--set '<text>'".
  SceneValues& set_text(const std::string& text, std::string origin = {});

  /// Chooses by a plugin's id; options in the file stay where they are that plugin's.
  SceneValues& choose_formulation(const std::string& id, const std::string& origin);
  SceneValues& choose_integrator(const std::string& id, const std::string& origin);
  /// Chooses with options alone, those of the file are dropped: a map as the file has it under `formulation` or
  /// `integrator`, its id under `name`.
  SceneValues& choose_formulation(Value choice, const std::string& origin);
  SceneValues& choose_integrator(Value choice, const std::string& origin);
  /// Gives a body a formulation of its own.
  SceneValues& body_formulation(const std::string& body, const std::string& id, const std::string& origin);
  /// Starts from a state of a model with the same coordinates, to the last bit.
  SceneValues& initial(const Model& model, const State& state, const std::string& origin);
  /// Replaces all prescribed motions by a map as the file has it under `motions`.
  SceneValues& motions(Value motions, const std::string& origin);
  /// What a command line asks for beyond the file: formulation, integrator, then every `--set`.
  SceneValues& apply(const SceneOptions& options);

  /// Everything as it was written and set, without defaults. `formulation` and `integrator` are in their long form.
  [[nodiscard]] const Value& root() const { return document_.root; }
  /// The value at a path as in set(); null where there is none.
  [[nodiscard]] const Value* find(std::string_view path) const;
  [[nodiscard]] const std::string& file() const { return file_; }
  /// The text that was read, comments and all.
  [[nodiscard]] const std::string& text() const { return text_; }
  /// Of that text: 64 hexadecimal digits.
  [[nodiscard]] const std::string& sha256() const { return sha256_; }
  /// The texts given to set_text, in their order.
  [[nodiscard]] const std::vector<std::string>& settings() const { return settings_; }
  /// Of every operation, in their order. Values that operation k brought have the line −1−k in their place.
  [[nodiscard]] const std::vector<std::string>& origins() const { return origins_; }
  [[nodiscard]] const Document& document() const { return document_; }
  /// What reading and operations have found wrong so far.
  [[nodiscard]] const Diagnostics& problems() const { return diagnostics_; }

 private:
  SceneValues() = default;
  int add_origin(std::string origin);
  /// \param value what is to be put there
  Value* target(const std::vector<std::string>& keys, int line, const Value& value);
  void take_away(const std::vector<std::string>& keys, int line);
  void put(const std::vector<std::string>& keys, Document read, int line);
  void put_choice(const char* key, Value choice, const std::string& origin);
  void choose(const char* key, const std::string& id, const std::string& origin);

  std::string file_, text_, sha256_;
  std::vector<std::string> settings_;
  Document document_;
  std::vector<std::string> origins_;
  Diagnostics diagnostics_;
};

/// A state as the values of `initial`: hinges, bodies, time and work, to the last bit.
Value state_value(const Model& model, const State& state);

}  // namespace withy
