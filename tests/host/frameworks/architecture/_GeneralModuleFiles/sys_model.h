// What the module of docs/recipes.md takes of Basilisk, declared as its interface is.
#pragma once
#include <cstdint>
#include <string>

class SysModel {
 public:
  virtual ~SysModel() {}
  virtual void Reset(std::uint64_t) {}
  virtual void UpdateState(std::uint64_t) {}
  std::string ModelTag;
  std::int64_t moduleID = 0;
};
