#include "sim/journal_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace sim {
namespace {

using Bytes = std::vector<unsigned char>;
constexpr std::uint64_t journal_magic = 0x314c4a5053554355ull;

std::string journal_name(const std::string& file) { return file + ".journal"; }

std::uint64_t checksum(const Bytes& bytes, std::size_t from) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (std::size_t i = from; i < bytes.size(); ++i) hash = (hash ^ bytes[i]) * 0x100000001b3ull;
  return hash;
}

bool write_all(int file, const void* data, std::size_t size, off_t at) {
  const char* bytes = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t done = pwrite(file, bytes, size, at);
    if (done <= 0) return false;
    bytes += done, at += done, size -= static_cast<std::size_t>(done);
  }
  return true;
}

bool read_all(int file, void* data, std::size_t size, off_t at) {  // beyond the end: zeros
  char* bytes = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t done = pread(file, bytes, size, at);
    if (done < 0) return false;
    if (done == 0) {
      std::memset(bytes, 0, size);
      return true;
    }
    bytes += done, at += done, size -= static_cast<std::size_t>(done);
  }
  return true;
}

// The number at `place` of the journal.
std::uint64_t number_at(const Bytes& bytes, std::size_t place) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + place, 8);
  return value;
}

// Whether the journal is complete: magic, checksum, and entries that end where it ends.
bool complete(const Bytes& bytes) {
  if (bytes.size() < 24 || number_at(bytes, 0) != journal_magic || number_at(bytes, 8) != checksum(bytes, 16)) return false;
  std::size_t place = 24;
  for (std::uint64_t i = 0; i < number_at(bytes, 16); ++i) {
    if (bytes.size() - place < 16 || bytes.size() - place - 16 < number_at(bytes, place + 8)) return false;
    place += 16 + number_at(bytes, place + 8);
  }
  return true;
}

// Applies a complete journal to its file, drops an incomplete one; then removes it. A journal that could not be applied stays.
void settle_journal(int file, int journal, const std::string& name) {
  struct stat about {};
  fstat(journal, &about);
  Bytes bytes(static_cast<std::size_t>(about.st_size));
  bool good = true;
  if (read_all(journal, bytes.data(), bytes.size(), 0) && complete(bytes)) {
    std::size_t place = 24;
    for (std::uint64_t i = 0; i < number_at(bytes, 16); ++i) {
      const std::uint64_t size = number_at(bytes, place + 8);
      good = good && file >= 0 && write_all(file, bytes.data() + place + 16, size, static_cast<off_t>(number_at(bytes, place)));
      place += 16 + size;
    }
  }
  if (good) unlink(journal_name(name).c_str());
}

// The open file. The first member has to be the library's.
struct JournalFile {
  H5FD_t base{};
  int file = -1, journal = -1;
  std::string name;
  haddr_t end_of_allocation = 0, size = 0;
  haddr_t finished = 0;              // bytes of the last finished state
  bool broken = false;               // a write failed (disk full): what came since the last finished state will never reach the file
  std::map<haddr_t, Bytes> pending;  // changes before `finished`, not overlapping
  dev_t device = 0;
  ino_t inode = 0;
};
JournalFile* of(H5FD_t* base) { return reinterpret_cast<JournalFile*>(base); }
const JournalFile* of(const H5FD_t* base) { return reinterpret_cast<const JournalFile*>(base); }

// Puts a change into the map, cutting what it covers.
void add_pending(JournalFile& file, haddr_t at, const unsigned char* data, std::size_t size) {
  const haddr_t end = at + size;
  auto it = file.pending.lower_bound(at);
  if (it != file.pending.begin() && std::prev(it)->first + std::prev(it)->second.size() > at) --it;
  while (it != file.pending.end() && it->first < end) {
    const haddr_t old_at = it->first, old_end = old_at + it->second.size();
    Bytes old = std::move(it->second);
    it = file.pending.erase(it);
    if (old_at < at) file.pending[old_at] = Bytes(old.begin(), old.begin() + static_cast<std::ptrdiff_t>(at - old_at));
    if (old_end > end) it = file.pending.emplace(end, Bytes(old.end() - static_cast<std::ptrdiff_t>(old_end - end), old.end())).first;
  }
  file.pending[at] = Bytes(data, data + size);
}

void append(Bytes& bytes, const void* data, std::size_t size) {
  const auto* first = static_cast<const unsigned char*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

// Journal: magic, checksum of the rest, number of entries, then (address, size, bytes) each.
Bytes journal_bytes(const std::map<haddr_t, Bytes>& pending) {
  Bytes bytes;
  const std::uint64_t zero = 0, count = pending.size();
  append(bytes, &journal_magic, 8);
  append(bytes, &zero, 8);
  append(bytes, &count, 8);
  for (const auto& [address, change] : pending) {
    const std::uint64_t at = address, size = change.size();
    append(bytes, &at, 8);
    append(bytes, &size, 8);
    append(bytes, change.data(), change.size());
  }
  const std::uint64_t sum = checksum(bytes, 16);
  std::memcpy(bytes.data() + 8, &sum, 8);
  return bytes;
}

bool commit(JournalFile& file) {
  if (file.broken) return false;
  if (!file.pending.empty()) {
    file.broken = true;  // until all of it is there; a complete journal is applied again by whoever opens the file next
    const Bytes bytes = journal_bytes(file.pending);
    if (!write_all(file.journal, bytes.data(), bytes.size(), 0)) return false;
    for (const auto& [address, change] : file.pending)
      if (!write_all(file.file, change.data(), change.size(), static_cast<off_t>(address))) return false;
    if (ftruncate(file.journal, 0) != 0) return false;
    file.pending.clear();
    file.broken = false;
  }
  file.finished = file.size;
  return true;
}

thread_local std::string problem;  // why the last file could not be opened

// The journal, opened and locked; -1 where that fails. It is emptied: what a killed writer left has been recovered before.
int lock_journal(const std::string& file) {
  for (int attempt = 0; attempt < 10; ++attempt) {
    const int journal = open(journal_name(file).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (journal < 0) {
      problem = std::strerror(errno);
      return -1;
    }
    if (flock(journal, LOCK_EX | LOCK_NB) != 0) {
      problem = "another run is writing it; wait for it, or stop it";
      close(journal);
      return -1;
    }
    struct stat mine {
    }, there{};  // whoever had it before may have removed it in between
    if (fstat(journal, &mine) == 0 && stat(journal_name(file).c_str(), &there) == 0 && mine.st_ino == there.st_ino &&
        ftruncate(journal, 0) == 0)
      return journal;
    close(journal);
  }
  problem = "its journal can't be locked";
  return -1;
}

H5FD_t* open_file(const char* name, unsigned flags, hid_t, haddr_t) {
  const bool writing = (flags & H5F_ACC_RDWR) != 0;
  int mode = writing ? O_RDWR : O_RDONLY;
  if (flags & H5F_ACC_TRUNC) mode |= O_TRUNC;
  if (flags & H5F_ACC_CREAT) mode |= O_CREAT;
  if (flags & H5F_ACC_EXCL) mode |= O_EXCL;
  const int journal = writing ? lock_journal(name) : -1;  // before the file is touched: it may be another's
  if (writing && journal < 0) return nullptr;
  const int descriptor = open(name, mode | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    problem = std::strerror(errno);
    if (journal >= 0) unlink(journal_name(name).c_str()), close(journal);
    return nullptr;
  }
  auto* file = new JournalFile;
  file->file = descriptor, file->name = name, file->journal = journal;
  struct stat about {};
  fstat(descriptor, &about);
  file->size = file->finished = static_cast<haddr_t>(about.st_size);
  file->device = about.st_dev, file->inode = about.st_ino;
  return &file->base;
}

herr_t close_file(H5FD_t* base) {
  JournalFile* file = of(base);
  bool good = true;
  if (file->journal >= 0) {
    const bool was_broken = file->broken;
    good = commit(*file) || was_broken;  // a failure before has been told by the flush that met it
    if (good) settle_journal(file->file, file->journal, file->name);
    close(file->journal);
  }
  close(file->file);
  delete file;
  return good ? 0 : -1;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const JournalFile *first = of(a), *second = of(b);
  if (first->device != second->device) return first->device < second->device ? -1 : 1;
  if (first->inode != second->inode) return first->inode < second->inode ? -1 : 1;
  return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  if (flags) *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t get_eoa(const H5FD_t* base, H5FD_mem_t) { return of(base)->end_of_allocation; }
herr_t set_eoa(H5FD_t* base, H5FD_mem_t, haddr_t address) {
  of(base)->end_of_allocation = address;
  return 0;
}
haddr_t get_eof(const H5FD_t* base, H5FD_mem_t) { return of(base)->size; }

herr_t read_bytes(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, void* buffer) {
  JournalFile* file = of(base);
  if (!read_all(file->file, buffer, size, static_cast<off_t>(at))) return -1;
  auto it = file->pending.lower_bound(at);
  if (it != file->pending.begin()) --it;
  for (; it != file->pending.end() && it->first < at + size; ++it) {
    const haddr_t from = std::max(at, it->first), to = std::min<haddr_t>(at + size, it->first + it->second.size());
    if (from < to) std::memcpy(static_cast<char*>(buffer) + (from - at), it->second.data() + (from - it->first), to - from);
  }
  return 0;
}

herr_t write_bytes(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, const void* buffer) {
  JournalFile* file = of(base);
  const auto* bytes = static_cast<const unsigned char*>(buffer);
  const std::size_t before = at < file->finished ? std::min<std::size_t>(size, file->finished - at) : 0;
  if (before > 0) add_pending(*file, at, bytes, before);
  // A write that fails is not told to the library, which could not close the file any more: it goes on in memory, and the next flush fails.
  const haddr_t behind = at + before;
  if (before < size && (file->broken || !write_all(file->file, bytes + before, size - before, static_cast<off_t>(behind)))) {
    file->broken = true;
    add_pending(*file, behind, bytes + before, size - before);
  }
  file->size = std::max<haddr_t>(file->size, at + size);
  return 0;
}

herr_t flush(H5FD_t* base, hid_t, hbool_t closing) {
  JournalFile* file = of(base);
  if (closing && file->broken) return 0;  // dropped by close_file
  return file->journal < 0 || commit(*file) ? 0 : -1;
}

herr_t truncate_file(H5FD_t* base, hid_t, hbool_t) {
  JournalFile* file = of(base);
  if (file->journal < 0 || file->broken || file->end_of_allocation <= file->size) return 0;  // a longer file does no harm
  if (ftruncate(file->file, static_cast<off_t>(file->end_of_allocation)) != 0) return -1;
  file->size = file->end_of_allocation;
  return 0;
}

hid_t driver() {
  static const H5FD_class_t description = [] {
    H5FD_class_t c{};
    c.name = "cusp_journal";
    c.maxaddr = (haddr_t{1} << 62) - 1;
    c.fc_degree = H5F_CLOSE_STRONG;
    c.open = open_file, c.close = close_file, c.cmp = compare, c.query = query;
    c.get_eoa = get_eoa, c.set_eoa = set_eoa, c.get_eof = get_eof;
    c.read = read_bytes, c.write = write_bytes, c.flush = flush, c.truncate = truncate_file;
    const H5FD_mem_t map[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(map), std::end(map), std::begin(c.fl_map));
    return c;
  }();
  static const hid_t id = H5FDregister(&description);
  return id;
}

}  // namespace

hid_t journal_access() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_driver(access, driver(), nullptr);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  return access;
}

bool recover_journal(const std::filesystem::path& file) {
  const std::string name = journal_name(file.string());
  const int journal = open(name.c_str(), O_RDWR | O_CLOEXEC);
  if (journal < 0) return false;
  if (flock(journal, LOCK_EX | LOCK_NB) != 0) {
    close(journal);
    return true;
  }
  const int target = open(file.c_str(), O_RDWR | O_CLOEXEC);
  settle_journal(target, journal, file.string());
  if (target >= 0) close(target);
  close(journal);
  return false;
}

std::string journal_problem() { return problem; }

}  // namespace sim
