// Memory that this process shares with a child it forks. Every other child gives it back, so that a
// wild write of one costs no other.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <new>

namespace isoline::benchmarks {

// Pages that are never written take no memory.
class SharedMemory {
 public:
  explicit SharedMemory(std::size_t bytes);
  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  void* address() const { return address_; }
  void release_pages();  // they are zero after that

  // In a child: gives back all but these.
  static void keep_only(std::initializer_list<const SharedMemory*> kept);

 private:
  void* address_;
  std::size_t bytes_;
};

// One object in memory of its own.
template <class T>
class Shared {
 public:
  Shared() : memory_(sizeof(T)) { renew(); }
  void renew() { object_ = new (memory_.address()) T; }
  T* operator->() const { return object_; }
  T& operator*() const { return *object_; }
  SharedMemory& memory() { return memory_; }

 private:
  SharedMemory memory_;
  T* object_;
};

}  // namespace isoline::benchmarks
