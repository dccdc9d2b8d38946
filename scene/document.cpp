#include "withy/scene/document.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <cerrno>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <system_error>
#include <unordered_set>
#include <vector>

#include "withy/scene/names.hpp"
#include "withy/scene/text_scan.hpp"
#include "withy/scene/units.hpp"
#include "withy/scene/whole_escapes.hpp"

namespace withy {
namespace {

/// Ends reading; its cause has been reported.
struct Stop {};

Value plain_scalar(const std::string& text) {
  if (text == "true" || text == "True" || text == "TRUE") return Value(true);
  if (text == "false" || text == "False" || text == "FALSE") return Value(false);
  if (const std::optional<double> x = plain_number(text)) return Value(*x);
  const bool negative = text.starts_with('-');
  const std::string magnitude = negative || text.starts_with('+') ? text.substr(1) : text;
  if (magnitude == ".inf" || magnitude == ".Inf" || magnitude == ".INF") {
    const double infinity = std::numeric_limits<double>::infinity();
    return Value(negative ? -infinity : infinity);
  }
  if (text == ".nan" || text == ".NaN" || text == ".NAN") return Value(std::numeric_limits<double>::quiet_NaN());
  return Value(text);
}

/// Builds the value tree from the events of the YAML parser.
class Builder final : public YAML::EventHandler {
 public:
  Builder(const WholeEscapes& text, const Origin& origin, Document& document, Diagnostics& diagnostics)
      : text_(text.text()), escapes_(text), origin_(origin), document_(document), diagnostics_(diagnostics) {}

  /// False once something was left out that checks would miss.
  [[nodiscard]] bool whole() const { return whole_; }
  [[nodiscard]] std::size_t documents() const { return documents_; }

  Place place(const YAML::Mark& mark, std::string path) const {
    if (origin_.line != 0) return {origin_.line, 0, std::move(path)};
    return {mark.line + 1, escapes_.column(mark.line + 1, mark.column + 1), std::move(path)};
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ == 1) return;
    stop(place(mark, ""), "a second document begins here; need one document");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    if (wants_key()) stop(place(mark, path()), "the key is empty; need a name");
    add(mark, Value());
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    diagnostics_.error(place(mark, path()), "aliases (*name) are not allowed; write the value itself");
    whole_ = false;
    if (wants_key()) throw Stop{};
    add(mark, Value());
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    if (wants_key()) return key(mark, value);
    // The mark of a scalar with a tag or anchor is that of the tag: refused already.
    if (is_left_open(mark)) stop(place(mark, path()), "the quote that begins here is never closed");
    // The system ends names of files there: another file than the text says would be read.
    if (value.find('\0') != std::string::npos) stop(place(mark, path()), "the text holds the character NUL");
    add(mark, tag == "!" ? Value(value) : plain_scalar(value));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Value::Kind::list, mark, tag, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Value::Kind::map, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  /// A list or map that is being filled.
  struct Level {
    Value value;
    std::string path;
    std::unordered_set<std::string> seen;
    std::optional<std::string> key;  ///< of the value that comes next, in a map
    bool repeated = false;           ///< that key was there before: its value is dropped
  };

  [[noreturn]] void stop(const Place& where, std::string message) {
    diagnostics_.error(where, std::move(message));
    throw Stop{};
  }

  /// True where a quoted scalar ends with the text: yaml-cpp 0.7 takes that for its end.
  bool is_left_open(const YAML::Mark& mark) const {
    const std::size_t start = mark.pos < 0 ? text_.size() : static_cast<std::size_t>(mark.pos);
    if (start >= text_.size() || (text_[start] != '"' && text_[start] != '\'')) return false;
    for (std::size_t i = start + 1; i < text_.size(); ++i) {
      if (text_[start] == '"' && text_[i] == '\\')
        ++i;
      else if (text_[i] != text_[start])
        continue;
      else if (text_[i] == '"' || text_.substr(i + 1, 1) != "'")
        return false;
      else
        ++i;  // '' is a quote inside single quotes
    }
    return true;
  }

  bool wants_key() const {
    return !levels_.empty() && levels_.back().value.kind() == Value::Kind::map && !levels_.back().key;
  }

  /// Path of the value that comes next.
  std::string path() const {
    if (levels_.empty()) return origin_.path;
    const Level& level = levels_.back();
    if (level.value.kind() == Value::Kind::list) return fmt::format("{}/{}", level.path, level.value.items().size());
    return level.key ? level.path + "/" + *level.key : level.path;
  }

  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0) diagnostics_.error(place(mark, path()), "anchors (&name) are not allowed");
  }

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (tag.empty() || tag == "?" || tag == "!") return;
    diagnostics_.error(place(mark, path()), fmt::format("tags are not allowed; got {}", in_quotes(tag)));
  }

  void key(const YAML::Mark& mark, const std::string& text) {
    Level& level = levels_.back();
    const Place where = place(mark, level.path + "/" + text.substr(0, DocumentLimits::key_bytes));
    if (text.size() > DocumentLimits::key_bytes) {
      stop(place(mark, level.path),
           fmt::format("key of {} bytes; need at most {}", text.size(), DocumentLimits::key_bytes));
    }
    for (const char c : text) {
      if (static_cast<unsigned char>(c) < 0x20) stop(place(mark, level.path), "the key holds a control character");
    }
    level.repeated = !level.seen.insert(text).second;
    if (level.repeated) {
      const Place& first = document_.keys[where.path];
      const std::string other =
          first.line > 0 ? fmt::format("; it stands at {}:{} already", first.line, first.column) : "";
      diagnostics_.error(where, fmt::format("duplicate key '{}'{}", text, other));
    } else {
      document_.keys.emplace(where.path, Place{where.line, where.column, {}});  // its path is the key here
    }
    level.key = text;
  }

  void count(const Place& where) {
    path_bytes_ += where.path.size();
    if (++values_ > DocumentLimits::values) stop(where, fmt::format("more than {} values", DocumentLimits::values));
    if (path_bytes_ > DocumentLimits::path_bytes) stop(where, "keys too long and nested for so many values");
  }

  void add(const YAML::Mark& mark, Value value) {
    // The mark of a value that is not there is that of what follows: its key says more.
    const auto key = value.kind() == Value::Kind::null ? document_.keys.find(path()) : document_.keys.end();
    value.set_place(key != document_.keys.end() ? Place{key->second.line, key->second.column, key->first}
                                                : place(mark, path()));
    count(value.place());
    put(std::move(value));
  }

  void put(Value value) {
    if (levels_.empty()) {
      document_.root = std::move(value);
      return;
    }
    Level& level = levels_.back();
    if (level.value.kind() == Value::Kind::list) {
      level.value.items().push_back(std::move(value));
      return;
    }
    if (!level.repeated) level.value.members().emplace_back(*level.key, std::move(value));
    level.key.reset();
  }

  void open(Value::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    if (wants_key())
      stop(place(mark, path()), "a list or map that is never closed, or stands as a key; need a name as key");
    const Place where = place(mark, path());
    count(where);
    if (levels_.size() >= static_cast<std::size_t>(DocumentLimits::depth)) {
      stop(where, fmt::format("nested deeper than {} levels", DocumentLimits::depth));
    }
    Level level;
    level.path = where.path;
    level.value = kind == Value::Kind::list ? Value::list({}, where) : Value::map({}, where);
    levels_.push_back(std::move(level));
  }

  void close() {
    Value value = std::move(levels_.back().value);
    levels_.pop_back();
    // It stays as long as the scene.
    if (value.kind() == Value::Kind::list)
      value.items().shrink_to_fit();
    else
      value.members().shrink_to_fit();
    put(std::move(value));
  }

  std::string_view text_;
  const WholeEscapes& escapes_;
  const Origin& origin_;
  Document& document_;
  Diagnostics& diagnostics_;
  std::vector<Level> levels_;
  std::size_t documents_ = 0;
  std::size_t values_ = 0;
  std::size_t path_bytes_ = 0;
  bool whole_ = true;
};

/// A line of a text, counted from 0.
std::string_view line_of(std::string_view text, int line) {
  for (; line > 0 && !text.empty(); --line) text.remove_prefix(std::min(text.size(), text.find('\n') + 1));
  return text.substr(0, text.find('\n'));
}
/// What a line begins with before its first word.
std::string_view indent_of(std::string_view line) { return line.substr(0, line.find_first_not_of(" \t")); }

/// What is wrong with a line where a ':' stands that cannot: its indentation, or that of no key of a map.
std::string misplaced_colon(std::string_view text, int line) {
  const std::string_view here = line_of(text, line), before = line > 0 ? line_of(text, line - 1) : std::string_view();
  if (indent_of(here).find('\t') != std::string_view::npos) return "a tab; indent with spaces, not tabs";
  const bool complete = before.find(": ") != std::string_view::npos && before.find('#') == std::string_view::npos;
  if (complete && indent_of(here).size() > indent_of(before).size())
    return "a ':' where none can stand; this line is indented farther than the one before, which has its value already";
  return "a ':' where none can stand; does the line before lack its own, or a text with ': ' its quotes?";
}

/// What the parser complains of, as who wrote the file would say it.
std::string syntax_problem(const YAML::Exception& e, std::string_view text) {
  namespace Says = YAML::ErrorMsg;
  const std::string& says = e.msg;
  if (says == Says::END_OF_MAP_FLOW)
    return "a map in braces goes on where it should end; is a ',' missing before here, or a '}'?";
  if (says == Says::END_OF_SEQ_FLOW)
    return "a list in brackets goes on where it should end; is a ',' missing before here, or a ']'?";
  if (says == Says::FLOW_END)
    return "this bracket or brace closes none that is open; is one of another kind still open?";
  if (says == Says::MAP_VALUE || says == Says::MAP_KEY) return misplaced_colon(text, e.mark.line);
  if (says == Says::BLOCK_ENTRY) return "a '-' where no list can begin; is the line indented as those around it?";
  const bool tab = says == Says::TAB_IN_INDENTATION || text.find("\n\t") != std::string_view::npos;
  if (tab) return "a tab; indent with spaces, not tabs";
  if (says == Says::END_OF_MAP || says == Says::END_OF_SEQ)
    return "this line is indented otherwise than those that it belongs to, or a line before lacks its ':'";
  return e.msg;
}

struct Descriptor {
  int number;
  ~Descriptor() { ::close(number); }
};

/// Waits until there is something to be read, or the end: of files never. Nobody may ever write into a pipe.
bool has_input(int file) {
  constexpr int patience = 10'000;  // ms
  pollfd waiting{file, POLLIN, 0};
  return ::poll(&waiting, 1, patience) != 0;
}

}  // namespace

std::string whole(const std::string& directory) {
  std::error_code none;
  return (std::filesystem::current_path(none) / directory).string();
}

std::string directory_now(const std::string& directory, const std::string& whole_directory) {
  return whole_directory.empty() || whole(directory) == whole_directory ? directory : whole_directory;
}

std::string Document::directory_now() const { return withy::directory_now(directory, whole_directory); }

Place Document::key_place(const std::string& path) const {
  for (std::string p = path; !p.empty(); p.erase(p.find_last_of('/'))) {
    if (const auto it = keys.find(p); it != keys.end()) return {it->second.line, it->second.column, path};
  }
  return {root.place().line, root.place().column, path};
}

bool read_document(std::string_view text, const Origin& origin, Document& document, Diagnostics& diagnostics) {
  if (text.size() > DocumentLimits::bytes) {
    diagnostics.error({1, 1, ""},
                      fmt::format("more than {} MiB; a scene is at most that large", DocumentLimits::bytes >> 20));
    return false;
  }
  if (const auto fault = scan_text(text)) {
    const Place file{fault->line, fault->column, origin.path};
    diagnostics.error(origin.line == 0 ? file : Place{origin.line, 0, origin.path}, fault->message);
    return false;
  }
  const WholeEscapes whole(text);
  Builder builder(whole, origin, document, diagnostics);
  try {
    std::istringstream stream{std::string(whole.text())};
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const Stop&) {
    return false;
  } catch (const YAML::Exception& e) {
    diagnostics.error(builder.place(e.mark, ""), "syntax: " + syntax_problem(e, text));
    return false;
  }
  if (builder.documents() == 0) {
    diagnostics.error({origin.line == 0 ? 1 : origin.line, 1, origin.path}, "empty; nothing to read");
    return false;
  }
  return builder.whole();
}

namespace {

/// What a file that cannot be read may have been; empty where nothing beside it has a name like it.
std::string meant_file(const std::string& file) {
  const std::filesystem::path path = file;
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) return " (it is a folder; name a file in it)";
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  std::vector<std::string> there;
  for (std::filesystem::directory_iterator entry(folder, none), end; !none && entry != end; entry.increment(none))
    if (there.push_back(entry->path().filename().string()); there.size() > 1000) break;
  const std::string guess = nearest(path.filename().string(), there);
  if (guess.empty() || guess == path.filename()) return {};
  return " (did you mean " + (path.has_parent_path() ? (folder / guess).string() : guess) + "?)";
}

}  // namespace

std::string read_bytes(const std::string& file) {
  const auto fail = [&](int error) -> void {
    throw std::system_error(error, std::generic_category(), "cannot read " + file + meant_file(file));
  };
  // A pipe is opened at once, whether or not somebody writes.
  const int opened = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (opened < 0) fail(errno);
  const Descriptor input{opened};
  std::string text, block(std::size_t{1} << 16, '\0');
  while (true) {
    if (text.size() > DocumentLimits::bytes) fail(EFBIG);
    if (!has_input(opened)) fail(ETIMEDOUT);
    const ssize_t count = ::read(opened, block.data(), block.size());
    if (count < 0 && errno != EINTR && errno != EAGAIN) fail(errno);
    if (count == 0) break;
    if (count > 0) text.append(block, 0, static_cast<std::size_t>(count));
  }
  return text;
}

}  // namespace withy
