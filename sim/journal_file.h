// HDF5 files that survive a kill: a file driver under which the file on disk changes from one finished state to the next, or not at all.
//
// New bytes behind the last finished state are written straight away: nothing refers to them yet. Changes before it are kept in memory
// until H5Fflush or H5Fclose; then they go into `FILE.journal` with a checksum, then into the file, then the journal is emptied. Whoever
// opens the file next applies a complete journal again (it may be applied twice) and drops an incomplete one. Where a write fails (disk
// full) H5Fflush fails, and the file stays as it was at the last flush that succeeded.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <string>

namespace sim {

// File-access property list for H5Fcreate / H5Fopen (read-write) with the driver; close it with H5Pclose.
hid_t journal_access();

// Finishes what a killed writer had begun; does nothing where there is no journal or its writer is alive. Returns true where a live writer
// has the file.
bool recover_journal(const std::filesystem::path& file);

// Why the last H5Fcreate or H5Fopen with the driver failed in this thread, in words.
std::string journal_problem();

}  // namespace sim
