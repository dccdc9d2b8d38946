// What the module of docs/recipes.md takes of Basilisk, declared as its interface is.
#pragma once
#include <cstdint>

template <typename T>
class ReadFunctor {
 public:
  const T& operator()();
};
template <typename T>
class WriteFunctor {
 public:
  void operator()(T* payload, std::int64_t module, std::uint64_t time);
};
template <typename T>
class Message {
 public:
  WriteFunctor<T> write;
  T zeroMsgPayload = {};
};
