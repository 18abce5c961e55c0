#include "faulty_disk.hpp"

#include <atomic>
#include <cstring>
#include <filesystem>
#include <thread>

#include <sqlite3.h>

namespace signorini::server {
namespace {

using Fault = FaultyDisk::Fault;

std::atomic<Fault> fault_now = Fault::none;
std::atomic<int> writes_left = 0;
std::atomic<int> sync_count = 0;
std::atomic<int> sync_milliseconds = 0;
std::atomic<std::int64_t> growth = 0;  ///< bytes of all files together since there is no room

/// The directory of the database that was opened last.
std::filesystem::path directory;

sqlite3_vfs* usual() {
  static sqlite3_vfs* const found = sqlite3_vfs_find(nullptr);
  return found;
}

/// The file of the usual layer lies behind it in the same memory.
struct File : sqlite3_file {
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
  const sqlite3_io_methods& methods() { return *real()->pMethods; }
};

File& of(sqlite3_file* file) {
  return *static_cast<File*>(file);
}

Fault fault_of_write() {
  const Fault fault = fault_now;
  if (fault == Fault::none || fault == Fault::cannot_sync || fault == Fault::no_room) return Fault::none;
  return writes_left.fetch_sub(1) > 0 ? Fault::none : fault;
}

/// Whether the file may be written up to there.
bool has_room(sqlite3_file* file, std::int64_t end) {
  sqlite3_int64 size = 0;
  of(file).methods().xFileSize(of(file).real(), &size);
  if (fault_now != Fault::no_room || end <= size) return true;
  constexpr std::int64_t room_of_reserve = 4 << 20;
  const bool spent = !std::filesystem::exists(directory / "reserve");
  if (growth + end - size > (spent ? room_of_reserve : 0)) return false;
  growth += end - size;
  return true;
}

int close(sqlite3_file* file) {
  return of(file).methods().xClose(of(file).real());
}

int read(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
  if (fault_now == Fault::cannot_access && writes_left <= 0) return SQLITE_IOERR_READ;
  return of(file).methods().xRead(of(file).real(), bytes, count, offset);
}

int write(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 offset) {
  const Fault fault = fault_of_write();
  if (fault == Fault::full) return SQLITE_FULL;
  if (fault == Fault::cannot_access) return SQLITE_IOERR_WRITE;
  if (!has_room(file, offset + count)) return SQLITE_FULL;
  return of(file).methods().xWrite(of(file).real(), bytes, count, offset);
}

int truncate(sqlite3_file* file, sqlite3_int64 size) {
  sqlite3_int64 before = 0;
  of(file).methods().xFileSize(of(file).real(), &before);
  if (fault_now == Fault::no_room) growth -= before - size;
  return of(file).methods().xTruncate(of(file).real(), size);
}

int sync(sqlite3_file* file, int flags) {
  if (fault_now == Fault::cannot_sync) return SQLITE_IOERR_FSYNC;
  ++sync_count;
  std::this_thread::sleep_for(std::chrono::milliseconds(sync_milliseconds));
  return of(file).methods().xSync(of(file).real(), flags);
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
  return of(file).methods().xFileSize(of(file).real(), size);
}

int lock(sqlite3_file* file, int level) {
  return of(file).methods().xLock(of(file).real(), level);
}

int unlock(sqlite3_file* file, int level) {
  return of(file).methods().xUnlock(of(file).real(), level);
}

int check_reserved_lock(sqlite3_file* file, int* result) {
  return of(file).methods().xCheckReservedLock(of(file).real(), result);
}

int file_control(sqlite3_file* file, int operation, void* argument) {
  return of(file).methods().xFileControl(of(file).real(), operation, argument);
}

int sector_size(sqlite3_file* file) {
  return of(file).methods().xSectorSize(of(file).real());
}

int device_characteristics(sqlite3_file* file) {
  return of(file).methods().xDeviceCharacteristics(of(file).real());
}

int shm_map(sqlite3_file* file, int page, int size, int extend, void volatile** memory) {
  return of(file).methods().xShmMap(of(file).real(), page, size, extend, memory);
}

int shm_lock(sqlite3_file* file, int offset, int count, int flags) {
  return of(file).methods().xShmLock(of(file).real(), offset, count, flags);
}

void shm_barrier(sqlite3_file* file) {
  of(file).methods().xShmBarrier(of(file).real());
}

int shm_unmap(sqlite3_file* file, int remove) {
  return of(file).methods().xShmUnmap(of(file).real(), remove);
}

/// Version 2 of the methods has shared memory, which WAL needs, and no memory mapping, which would go past
/// the faults.
constexpr sqlite3_io_methods methods{2,
                                     close,
                                     read,
                                     write,
                                     truncate,
                                     sync,
                                     file_size,
                                     lock,
                                     unlock,
                                     check_reserved_lock,
                                     file_control,
                                     sector_size,
                                     device_characteristics,
                                     shm_map,
                                     shm_lock,
                                     shm_barrier,
                                     shm_unmap,
                                     nullptr,
                                     nullptr};

int open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* flags_out) {
  File& wrapper = of(file);
  if ((flags & SQLITE_OPEN_MAIN_DB) != 0) directory = std::filesystem::path(name).parent_path();
  const int code = usual()->xOpen(usual(), name, wrapper.real(), flags, flags_out);
  wrapper.pMethods = wrapper.real()->pMethods == nullptr ? nullptr : &methods;
  return code;
}

sqlite3_vfs make_vfs() {
  sqlite3_vfs vfs = *usual();
  vfs.szOsFile += static_cast<int>(sizeof(File));
  vfs.zName = "faulty-disk";
  vfs.pNext = nullptr;
  vfs.xOpen = open;
  return vfs;
}

}  // namespace

std::string FaultyDisk::vfs() {
  static sqlite3_vfs vfs = make_vfs();
  static const int registered = sqlite3_vfs_register(&vfs, 0);
  return registered == SQLITE_OK ? vfs.zName : "";
}

int FaultyDisk::syncs() {
  return sync_count;
}

void FaultyDisk::slow_down(std::chrono::milliseconds sync) {
  sync_milliseconds = static_cast<int>(sync.count());
}

void FaultyDisk::fail(Fault fault, int writes_before) {
  growth = 0;
  writes_left = writes_before;
  fault_now = fault;
}

}  // namespace signorini::server
